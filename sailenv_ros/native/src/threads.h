// A pool of threads that work on a picture's row tiles.
//
// Which thread takes which tile is left to chance, so a tile must not depend on another one: the
// bytes of a result are then the same on any number of threads.
#pragma once

#include <cstdint>

namespace sailenv {

// Works on one tile. `slot` is below the number of threads of the call, and no two threads that
// work at the same time have the same one: it picks a thread's scratch memory.
using TileFunction = void (*)(void* context, int64_t tile, int64_t slot);

// Calls `function` for every tile from 0 to `tiles` - 1, on the calling thread and up to
// `threads` - 1 others, and returns when all tiles are done. May be called by several threads at
// once, and from within a tile. The functions must not throw.
void run_tiles(int64_t threads, int64_t tiles, TileFunction function, void* context);

// Calls body(first, last, slot) for tiles of `tile_rows` rows (the last one may be smaller).
template <class Body>
void parallel_for(int64_t threads, int64_t rows, int64_t tile_rows, const Body& body) {
    struct Context {
        const Body& body;
        int64_t rows, tile_rows;
    } context{body, rows, tile_rows};
    const int64_t tiles = (rows + tile_rows - 1) / tile_rows;
    run_tiles(
        threads, tiles,
        [](void* opaque, int64_t tile, int64_t slot) {
            const Context& c = *static_cast<const Context*>(opaque);
            const int64_t first = tile * c.tile_rows;
            const int64_t last = first + c.tile_rows;
            c.body(first, last < c.rows ? last : c.rows, slot);
        },
        &context);
}

}  // namespace sailenv
