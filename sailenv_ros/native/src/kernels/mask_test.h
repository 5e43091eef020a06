// Which samples of a surface with holes are there.
#pragma once

#include "lens_table.h"
#include "raster.h"
#include "texture.h"

namespace sailenv {

// What alpha testing needs of a triangle: planes of uv over depth; of uv where rays are parallel.
struct MaskedTriangle {
    float u[3], v[3];
    float slopes[2];  // of what the planes are over, as `inverse_depth`
    bool parallel;
    const uint32_t* texels;
    int32_t log2_size;
};

static inline MaskedTriangle masked_triangle(const Triangle& t, const Part& part, bool parallel) {
    MaskedTriangle m{};
    m.parallel = parallel;
    for (int k = 0; k < 2; k++) m.slopes[k] = parallel ? 0.0f : t.inverse_depth[k];
    const bool textured = part.colour_map != nullptr;
    m.texels = textured ? part.colour_map->texels : WHITE_TEXELS;
    m.log2_size = textured ? static_cast<int32_t>(part.colour_map->log2_size) : 0;
    for (int k = 0; k < 3; k++) {
        const float* vertex = part.vertices + 8 * static_cast<int64_t>(t.vertex[k]);
        for (int j = 0; j < 3; j++) {
            const float share = t.edge[3 * k + j] * t.inverse_det;
            m.u[j] += vertex[3] * share;
            m.v[j] += vertex[4] * share;
        }
    }
    return m;
}

// Which of eight pixels of a masked material are there.
template <class Row, class Steps>
static inline i8 opaque_pixels(const MaskedTriangle& m, const Part& part, f8 x, Row y,
                               const Steps& steps, f8 inverse_depth, i8 wanted) {
    const f8 depth = m.parallel ? splat(1.0f) : 1.0f / inverse_depth;
    const f8 u = (m.u[0] * x + (m.u[1] * y + m.u[2])) * depth;
    const f8 v = (m.v[0] * x + (m.v[1] * y + m.v[2])) * depth;
    const i8 size = splat(m.log2_size);
    const f8 ux = depth * (m.u[0] - u * m.slopes[0]), vx = depth * (m.v[0] - v * m.slopes[0]),
             uy = depth * (m.u[1] - u * m.slopes[1]), vy = depth * (m.v[1] - v * m.slopes[1]);
    const f8 level =
        level_of_detail(to_right(steps, ux, uy), to_right(steps, vx, vy), downwards(steps, ux, uy),
                        downwards(steps, vx, vy), size, 0.0f);
    const auto [near, far, share] = mip_taps(u, v, size, level);
    f8 alpha = splat(0.0f);
    for (int k = 0; k < 8; k++) {
        if (!wanted[k]) continue;
        const float a =
            sample_bytes(m.texels, near.upper[k], near.lower[k], near.across[k], near.down[k])[3];
        const float b =
            sample_bytes(m.texels, far.upper[k], far.lower[k], far.across[k], far.down[k])[3];
        alpha[k] = (a + (b - a) * share[k]) * (1.0f / 255.0f);
    }
    const float least = min(part.alpha_cutoff, part.least_cutoff);
    const f8 cutoff = max8(part.alpha_cutoff - part.cutoff_fall * level, splat(least));
    return wanted & (alpha * part.colour[3] >= cutoff);
}

}  // namespace sailenv
