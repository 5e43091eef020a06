// Textures as render_types.h has them, made from their finest level.
#include <cstring>

#include "../abi.h"
#include "traced_types.h"

namespace {

// Writes a row of texels and its first one again.
void put_row(uint32_t* out, const uint8_t* row, int64_t edge) {
    memcpy(out, row, static_cast<size_t>(edge) * 4);
    out[edge] = out[0];
}

}  // namespace

// `texels` (edge, edge, 4) and all coarser levels, into `chain`.
SAILENV_KERNEL(mip_chain)(const uint8_t* texels, int64_t edge, uint32_t* chain) {
    if (edge < 1 || edge > 4096 || (edge & (edge - 1)) != 0) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    for (int64_t y = 0; y < edge; y++) put_row(chain + y * (edge + 1), texels + 4 * y * edge, edge);
    const uint8_t* finer = reinterpret_cast<const uint8_t*>(chain);
    uint32_t* out = chain + edge * (edge + 1);
    for (int64_t size = edge / 2; size >= 1; size /= 2) {
        const int64_t row = 4 * (2 * size + 1);
        uint8_t* to = reinterpret_cast<uint8_t*>(out);
        for (int64_t y = 0; y < size; y++) {
            const uint8_t* upper = finer + 2 * y * row;
            uint8_t* line = to + 4 * y * (size + 1);
            for (int64_t x = 0; x < size; x++) {
                for (int64_t c = 0; c < 4; c++) {
                    const uint8_t* p = upper + 8 * x + c;
                    line[4 * x + c] =
                        static_cast<uint8_t>((p[0] + p[4] + p[row] + p[row + 4] + 2) >> 2);
                }
            }
            memcpy(line + 4 * size, line, 4);
        }
        finer = to;
        out += size * (size + 1);
    }
    return sailenv::STATUS_OK;
}

// Sizes of the structures that Python mirrors, in the order of drawing.py.
SAILENV_KERNEL(structure_sizes)(int64_t* sizes) {
    sizes[0] = sizeof(sailenv::Part);
    sizes[1] = sizeof(sailenv::Instances);
    sizes[2] = sizeof(sailenv::Light);
    sizes[3] = sizeof(sailenv::View);
    sizes[4] = sizeof(sailenv::Outputs);
    sizes[5] = sizeof(sailenv::LayerSum);
    sizes[6] = sizeof(sailenv::LensTable);
    sizes[7] = sizeof(sailenv::CubeFace);
    sizes[8] = sizeof(sailenv::LensTiles);
    sizes[9] = sizeof(sailenv::TrianglePlace);
    sizes[10] = sizeof(sailenv::TracedInstance);
    sizes[11] = sizeof(sailenv::TracedScene);
    return sailenv::STATUS_OK;
}
