// Light maps and reflection maps, brought up to date when lights change.
#include "../abi.h"
#include "../threads.h"
#include "layer_sum.h"
#include "texture.h"

// The sum of layers of a light map, in the order of lightmap_compositing.sum_texels.
SAILENV_KERNEL(sum_texels)(int64_t threads, const sailenv::LayerSum* sum) {
    if (sum->count < 0 || sum->count % 8 != 0 || sum->terms < 1 || sum->channels[0] != 3) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    sailenv::parallel_for(threads, sum->count, 8192, [&](int64_t first, int64_t last, int64_t) {
        sailenv::add_layers(*sum, first, last);
    });
    return sailenv::STATUS_OK;
}

// The mean over a lobe about each direction of an octahedral map; see reflection_map.prefilter.
// `edge` is a multiple of eight; `radiance` has four channels, of which three are read, `lobe`
// holds directions about z and their weights.
SAILENV_KERNEL(blur_directions)
(int64_t threads, int64_t edge, const float* radiance, const float* directions, int64_t samples,
 const float* lobe, float* out) {
    if (edge < 8 || edge % 8 != 0 || edge > 4096) return sailenv::STATUS_INVALID_ARGUMENT;
    const float scale = 0.5f * static_cast<float>(edge), last = static_cast<float>(edge - 1);
    sailenv::parallel_for(threads, edge, 4, [&](int64_t first, int64_t end, int64_t) {
        for (int64_t at = first * edge; at < end * edge; at += 8) {
            f8 nx, ny, nz;
            for (int k = 0; k < 8; k++) {
                nx[k] = directions[3 * (at + k)];
                ny[k] = directions[3 * (at + k) + 1];
                nz[k] = directions[3 * (at + k) + 2];
            }
            // A frame about the normal without trigonometry (Duff et al. 2017).
            const f8 sign = nz >= 0.0f ? splat(1.0f) : splat(-1.0f);
            const f8 a = -1.0f / (sign + nz), b = nx * ny * a;
            const f8 xx = 1.0f + sign * nx * nx * a, yx = sign * b, zx = -sign * nx;
            const f8 yy = sign + ny * ny * a;
            f8 sum[3] = {splat(0.0f), splat(0.0f), splat(0.0f)};
            float total = 0.0f;
            for (int64_t s = 0; s < samples; s++) {
                const float lx = lobe[4 * s], ly = lobe[4 * s + 1], lz = lobe[4 * s + 2],
                            weight = lobe[4 * s + 3];
                if (!(weight > 0.0f)) continue;
                const f8 x = lx * xx + ly * b + lz * nx, y = lx * yx + ly * yy + lz * ny,
                         z = lx * zx - ly * ny + lz * nz;
                const f8 inverse = 1.0f / (abs8(x) + abs8(y) + abs8(z));
                const f8 px = x * inverse, py = y * inverse;
                const i8 below = z < 0.0f;
                const f8 qx = (1.0f - abs8(py)) * (px >= 0.0f ? splat(1.0f) : splat(-1.0f));
                const f8 qy = (1.0f - abs8(px)) * (py >= 0.0f ? splat(1.0f) : splat(-1.0f));
                const f8 u = clamp8((below ? qx : px) * scale + scale, 0.0f, last);
                const f8 v = clamp8((below ? qy : py) * scale + scale, 0.0f, last);
                const i8 place = truncated(v) * static_cast<int32_t>(edge) + truncated(u);
                alignas(32) float texels[4 * 8];
                for (int k = 0; k < 8; k++) {
                    memcpy(texels + 4 * k, radiance + 4 * static_cast<int64_t>(place[k]), 16);
                }
                f8 r, g, blue, unused;
                transpose4(texels, r, g, blue, unused);
                sum[0] = sum[0] + r * weight;
                sum[1] = sum[1] + g * weight;
                sum[2] = sum[2] + blue * weight;
                total += weight;
            }
            for (int k = 0; k < 8; k++) {
                for (int c = 0; c < 3; c++) out[3 * (at + k) + c] = sum[c][k] / total;
            }
        }
    });
    return sailenv::STATUS_OK;
}
