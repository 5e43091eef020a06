// From radiance to the 8-bit picture: ambient occlusion, tone curve, sRGB, smooth edges; see
// render/tone_map.py and render/smooth_edges.py.
#include "../abi.h"
#include "../threads.h"
#include "ambient_share.h"
#include "bytes.h"
#include "lanes.h"
#include "scratch.h"

namespace {

using sailenv::AmbientVisibility;

constexpr int64_t TILE_ROWS = 16, TILE_COLUMNS = 64;
constexpr int64_t CHUNK = 64;  // pixels whose factors and table indices stay in the first cache

struct Picture {
    int64_t height, width;
    const uint16_t* radiance;  // (H, W, 4), bits of halves: red, green, blue, share from around
    const float* surface;      // (H, W, 2): depth and instance id
    AmbientVisibility ambient;
    const uint8_t* table;  // (65536,): stored value of each half by its bits
};

// Share of their light that is left to neighbouring pixels of a row.
void find_factors(const Picture& p, int64_t v, int64_t first, int64_t count, float* factors) {
    const sailenv::SampleRows rows(p.ambient, v / 2);
    const float* surface = p.surface + 2 * (v * p.width + first);
    const uint16_t* radiance = p.radiance + 4 * (v * p.width + first);
    int64_t k = 0;
    for (; k + 8 <= count && (first + k) / 2 + 5 <= p.ambient.columns; k += 8) {
        store(factors + k, sailenv::arriving_factors(rows, (first + k) / 2, surface + 2 * k,
                                                     radiance + 4 * k, p.ambient.same_surface));
    }
    for (; k < count; k++) {
        const int32_t visibility =
            sailenv::arriving(rows, (first + k) / 2, surface[2 * k], p.ambient.same_surface);
        factors[k] = sailenv::arriving_factor(radiance[4 * k + 3], visibility);
    }
}

// Tells if all light arrives at neighbouring pixels of a row.
bool all_arrives(const Picture& p, int64_t v, int64_t first, int64_t count) {
    const sailenv::SampleRows rows(p.ambient, v / 2);
    const int64_t begin = first / 2, end = (first + count - 1) / 2 + 2;
    uint8_t least = 255;
    for (int64_t k = begin; k < (end < p.ambient.columns ? end : p.ambient.columns); k++) {
        least = least < rows.visibility[0][k] ? least : rows.visibility[0][k];
        least = least < rows.visibility[1][k] ? least : rows.visibility[1][k];
    }
    return least == 255;
}

// The light of a chunk less what does not arrive, as bits of halves (4 a pixel).
void scale_chunk(const Picture& p, int64_t v, int64_t first, int64_t count, uint16_t* out) {
    float factors[CHUNK + 8];
    find_factors(p, v, first, count, factors);
    const uint16_t* radiance = p.radiance + 4 * (v * p.width + first);
    int64_t k = 0;
    for (; k + 2 <= count; k += 2) {
        const float a = factors[k], b = factors[k + 1];
        const i8 light = sailenv::load_half_bits(radiance + 4 * k);
        const f8 left = number(light << 13) * f8{a, a, a, 1.0f, b, b, b, 1.0f};
        sailenv::store_half_bits(out + 4 * k, (bits(left) + 4096) >> 13);
    }
    if (k < count) {
        for (int c = 0; c < 3; c++) {
            const float left = sailenv::small_number(radiance[4 * k + c]) * factors[k];
            int32_t shifted;
            memcpy(&shifted, &left, sizeof shifted);
            out[4 * k + c] = static_cast<uint16_t>((shifted + 4096) >> 13);
        }
    }
}

// Writes stored values, four bytes a pixel, the fourth their luma, and the luma by itself; or three
// bytes a pixel.
void tone_map_row(const Picture& p, int64_t v, uint8_t* four, uint8_t* luma, uint8_t* three) {
    uint16_t scratch[4 * CHUNK];
    for (int64_t first = 0; first < p.width; first += CHUNK) {
        const int64_t count = first + CHUNK < p.width ? CHUNK : p.width - first;
        const uint16_t* light = p.radiance + 4 * (v * p.width + first);
        if (p.ambient.visibility != nullptr && !all_arrives(p, v, first, count)) {
            scale_chunk(p, v, first, count, scratch);
            light = scratch;
        }
        if (three != nullptr) {
            uint8_t* out = three + 3 * first;
            for (int64_t k = 0; k < count; k++) {
                for (int c = 0; c < 3; c++) out[3 * k + c] = p.table[light[4 * k + c]];
            }
            continue;
        }
        for (int64_t k = 0; k < count; k++) {
            const uint32_t r = p.table[light[4 * k]], g = p.table[light[4 * k + 1]],
                           b = p.table[light[4 * k + 2]];
            // Luma of ITU-R BT.601 in 256ths.
            const uint32_t y = (77 * r + 150 * g + 29 * b + 128) >> 8;
            const uint32_t pixel = r | g << 8 | b << 16 | y << 24;
            memcpy(four + 4 * (first + k), &pixel, 4);
            luma[first + k] = static_cast<uint8_t>(y);
        }
    }
}

// Stored values and their luma: row by row and, for edges that run down the picture, column by
// column. The luma begins PAD bytes into each line, so that what is read beyond an end is there.
constexpr int64_t PAD = 16;
constexpr float LEAST_BEND = 0.0005f;  // share of 1 / depth

struct Edges {
    int64_t height, width;
    const uint8_t* four;     // (H, W, 4)
    const float* surface;    // (H, W, 2): depth and instance id; or null
    const uint8_t* rows;     // (H, PAD + W + PAD)
    const uint8_t* columns;  // (W, PAD + H + PAD)
    int64_t row_stride, column_stride;
    int32_t least_contrast, reach_px;
    double shares[17][17];  // by the steps to the nearer end and to the other one
};

// The other luma plane, of some columns of the picture.
void transpose_luma(const Edges& e, int64_t first, int64_t last, uint8_t* columns) {
    for (int64_t v = 0; v < e.height; v += 16) {
        for (int64_t u = first; u < last; u += 16) {
            const uint8_t* from = e.rows + v * e.row_stride + PAD + u;
            uint8_t* to = columns + u * e.column_stride + PAD + v;
            const int64_t down = e.height - v < 16 ? e.height - v : 16;
            const int64_t across = last - u < 16 ? last - u : 16;
            b16 block[16];
            for (int64_t k = 0; k < 16; k++) {
                block[k] = k < down ? load16(from + k * e.row_stride) : b16{};
            }
            transpose16(block);
            // Beyond the end of a column there is room for as much as one load reads.
            for (int64_t k = 0; k < across; k++) {
                memcpy(to + k * e.column_stride, &block[k], sizeof(b16));
            }
        }
    }
}

// How far the ends of an edge may lie, and share of the pixel across it by where they lie: a line
// from the middle of the step there to the edge's middle is half a pixel high at the step.
void set_shares(Edges& e) {
    for (int32_t nearer = 1; nearer <= 16; nearer++) {
        for (int32_t other = 1; other <= 16; other++) {
            const int32_t length = nearer + other - 1;
            const double share = length > 1 ? 0.5 - (nearer - 0.5) / length : 0.25;
            e.shares[nearer][other] = share > 0.0 ? share : 0.0;
        }
    }
}

struct End {
    int32_t steps;
    bool crosses;  // the edge steps towards this pixel's side, not away from it
};

// Share of a pixel that lies across its edge, 0 to 0.5. `here` and `there` are the luma of the
// pixel and of the one across the edge, each in the line along the edge, which has `before` pixels
// before this one and `after` after it.
double share_across(const Edges& e, const uint8_t* here, const uint8_t* there, int64_t before,
                    int64_t after, int32_t contrast) {
    const int32_t twice_middle = *here + *there;
    const bool brighter = 2 * *here > twice_middle;
    const b16 least_difference = splat16(static_cast<uint8_t>((contrast + 1) / 2));
    const b16 least_bright = splat16(static_cast<uint8_t>(twice_middle / 2 + 1));
    // Where the edge ends, and where its side is bright: a bit for each of sixteen neighbours.
    const auto find = [&](int64_t at, uint32_t& bright) {
        const b16 own = load16(here + at), other = load16(there + at);
        bright = mask16(own >= least_bright);
        const b16 difference = max16(own, other) - min16(own, other);
        const uint32_t steep = mask16(difference >= least_difference);
        return ~(steep & (brighter ? bright : ~bright)) & 0xffff;
    };
    End ends[2] = {{e.reach_px, false}, {e.reach_px, false}};
    uint32_t bright;
    const int64_t far_before = before < e.reach_px ? before : e.reach_px;
    const uint32_t before_mask = find(-16, bright) & (0xffff0000u >> far_before);
    if (before_mask != 0) {
        const int bit = 31 - __builtin_clz(before_mask);
        ends[0] = {16 - bit, ((bright >> bit & 1) != 0) != brighter};
    }
    const int64_t far_after = after < e.reach_px ? after : e.reach_px;
    const uint32_t after_mask = find(1, bright) & ((1u << far_after) - 1);
    if (after_mask != 0) {
        const int bit = __builtin_ctz(after_mask);
        ends[1] = {bit + 1, ((bright >> bit & 1) != 0) != brighter};
    }
    const bool first = ends[0].steps <= ends[1].steps;
    const End& nearer = ends[first ? 0 : 1];
    const End& other = ends[first ? 1 : 0];
    if (nearer.steps == e.reach_px || !nearer.crosses) return 0.0;
    return e.shares[nearer.steps][other.steps];
}

// How far a pixel's luma lies above both neighbours or below both, if these are alike.
LANES_INLINE int32_t stands_out(int32_t own, int32_t before, int32_t after) {
    int32_t least = 0;
    if (own > before && own > after) least = own - (before > after ? before : after);
    if (own < before && own < after) least = (before < after ? before : after) - own;
    const int32_t unlike = before > after ? before - after : after - before;
    return unlike <= least ? least : 0;
}

// Tells if a pixel's surface lies off that between its neighbours: over a plane 1 / depth is
// linear.
LANES_INLINE bool bends(const float* surface, int64_t next) {
    const float own = 1.0f / surface[0];
    const float both = 1.0f / surface[-2 * next] + 1.0f / surface[2 * next];
    return __builtin_fabsf(both - (own + own)) > LEAST_BEND * own;
}

// Something narrower than a pixel is seen in one pixel and missed in the next. Of a line half is
// left, half is what lies on both sides; of a dot nothing. Tells if the pixel was one.
bool smooth_thin(const Edges& e, int64_t v, int64_t u, uint8_t* out) {
    if (e.surface == nullptr) return false;
    const uint8_t* row = e.rows + v * e.row_stride + PAD + u;
    const int32_t across = stands_out(row[0], row[-1], row[1]);
    const int32_t down = stands_out(row[0], row[-e.row_stride], row[e.row_stride]);
    if ((across > down ? across : down) < e.least_contrast) return false;
    const int64_t next = across >= down ? 1 : e.width;
    const int64_t at = v * e.width + u;
    if (!bends(e.surface + 2 * at, next)) return false;
    const uint8_t* own = e.four + 4 * at;
    int32_t low = 255, high = 0;
    for (int64_t k = -1; k <= 1; k++) {
        for (int64_t j = -1; j <= 1; j++) {
            if (k == 0 && j == 0) continue;
            const int32_t there = row[k * e.row_stride + j];
            low = there < low ? there : low;
            high = there > high ? there : high;
        }
    }
    // A dot stands out from all that is around it, by more than that differs.
    const int32_t least = row[0] > high ? row[0] - high : low - row[0];
    const bool dot = least >= e.least_contrast && high - low <= least;
    for (int c = 0; c < 3; c++) {
        const uint8_t* p = own + c;
        const int32_t beside = p[-4 * next] + p[4 * next];
        const int32_t around = p[-4] + p[4] + p[-4 * e.width] + p[4 * e.width];
        const int32_t mixed = dot ? (around + 2) >> 2 : (2 * *p + beside + 2) >> 2;
        out[c] = static_cast<uint8_t>(mixed);
    }
    return true;
}

LANES_INLINE int32_t distance(uint8_t a, uint8_t b) { return a > b ? a - b : b - a; }

void smooth_pixel(const Edges& e, int64_t v, int64_t u, int32_t contrast, uint8_t* out) {
    if (smooth_thin(e, v, u, out)) return;
    const uint8_t* row = e.rows + v * e.row_stride + PAD + u;
    const int32_t up = distance(row[-e.row_stride], row[0]);
    const int32_t down = distance(row[e.row_stride], row[0]);
    const int32_t left = distance(row[-1], row[0]), right = distance(row[1], row[0]);
    int64_t across;
    double share;
    if ((up > down ? up : down) >= (left > right ? left : right)) {
        const int64_t dv = up > down ? -1 : 1;
        across = dv * e.width;
        share = share_across(e, row, row + dv * e.row_stride, u, e.width - 1 - u, contrast);
    } else {
        const int64_t du = left > right ? -1 : 1;
        const uint8_t* column = e.columns + u * e.column_stride + PAD + v;
        across = du;
        share =
            share_across(e, column, column + du * e.column_stride, v, e.height - 1 - v, contrast);
    }
    if (share <= 0.0) return;
    const uint8_t* own = e.four + 4 * (v * e.width + u);
    for (int c = 0; c < 3; c++) {
        const double mixed = own[c] + (own[4 * across + c] - own[c]) * share + 0.5;
        out[c] = static_cast<uint8_t>(mixed);
    }
}

void drop_luma(const uint8_t* four, int64_t count, uint8_t* three) {
    int64_t k = 0;
    // Four bytes at a time, of which the next pixel overwrites the last.
    for (; k + 1 < count; k++) memcpy(three + 3 * k, four + 4 * k, 4);
    if (k < count) memcpy(three + 3 * k, four + 4 * k, 3);
}

void smooth_row(const Edges& e, int64_t v, uint8_t* three) {
    drop_luma(e.four + 4 * v * e.width, e.width, three);
    if (v == 0 || v + 1 == e.height) return;
    const uint8_t* row = e.rows + v * e.row_stride + PAD;
    for (int64_t first = 1; first < e.width - 1; first += 16) {
        // Greatest difference to the four neighbours.
        const b16 here = load16(row + first);
        const b16 across = max16(distance16(load16(row + first - e.row_stride), here),
                                 distance16(load16(row + first + e.row_stride), here));
        const b16 along = max16(distance16(load16(row + first - 1), here),
                                distance16(load16(row + first + 1), here));
        const b16 contrast = max16(across, along);
        uint32_t edges = mask16(contrast >= splat16(static_cast<uint8_t>(e.least_contrast)));
        const int64_t inner = e.width - 1 - first;
        if (inner < 16) edges &= (1u << inner) - 1;
        for (; edges != 0; edges &= edges - 1) {
            const int bit = __builtin_ctz(edges);
            smooth_pixel(e, v, first + bit, contrast[bit], three + 3 * (first + bit));
        }
    }
}

}  // namespace

// `visibility` may be null, and then `inverse` too; without it `surface` may be. `least_contrast` 0
// leaves edges as they are. `rgb` is (height, width, 3).
SAILENV_KERNEL(make_picture)
(int64_t threads, int64_t height, int64_t width, const uint16_t* radiance, const uint8_t* table,
 const uint8_t* visibility, const float* inverse, const float* surface, double same_surface,
 int64_t least_contrast, int64_t reach_px, uint8_t* rgb) {
    if (height < 0 || width < 0) return sailenv::STATUS_INVALID_ARGUMENT;
    const AmbientVisibility ambient{visibility, inverse, (height + 1) / 2, (width + 1) / 2,
                                    static_cast<float>(same_surface)};
    const Picture picture{height, width, radiance, surface, ambient, table};
    if (least_contrast <= 0) {
        sailenv::parallel_for(
            threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
                for (int64_t v = first; v < last; v++) {
                    tone_map_row(picture, v, nullptr, nullptr, rgb + 3 * v * width);
                }
            });
        return sailenv::STATUS_OK;
    }
    if (least_contrast > 255 || reach_px < 1 || reach_px > 15) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    const int64_t row_stride = width + 2 * PAD, column_stride = height + 2 * PAD;
    const auto four = sailenv::allocate<uint8_t>(4 * height * width);
    const auto rows = sailenv::allocate<uint8_t>(height * row_stride);
    const auto columns = sailenv::allocate<uint8_t>(width * column_stride);
    if (!four || !rows || !columns) return sailenv::STATUS_OUT_OF_MEMORY;
    Edges edges{height,
                width,
                four.get(),
                surface,
                rows.get(),
                columns.get(),
                row_stride,
                column_stride,
                static_cast<int32_t>(least_contrast),
                static_cast<int32_t>(reach_px),
                {}};
    set_shares(edges);
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) {
            tone_map_row(picture, v, four.get() + 4 * v * width, rows.get() + v * row_stride + PAD,
                         nullptr);
        }
    });
    sailenv::parallel_for(threads, width, TILE_COLUMNS, [&](int64_t first, int64_t last, int64_t) {
        transpose_luma(edges, first, last, columns.get());
    });
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) smooth_row(edges, v, rgb + 3 * v * width);
    });
    return sailenv::STATUS_OK;
}
