// The light of probes where surfaces are.
#include <algorithm>
#include <cstring>

#include "../abi.h"
#include "../threads.h"

// Interpolates the light of probes at points that face along normals, without cutting off below 0.
// probes: (z, y, x, 4, channels); result: (count, channels).
SAILENV_KERNEL(light_of_probes)
(int64_t threads, int64_t nz, int64_t ny, int64_t nx, int64_t channels, const float* probes,
 const float* origin, const float* spacing, int64_t count, const float* positions,
 const float* normals, float* result) {
    using namespace sailenv;
    if (nz < 1 || ny < 1 || nx < 1 || channels < 1 || count < 0) return STATUS_INVALID_ARGUMENT;
    const int64_t size[3] = {nx, ny, nz};
    parallel_for(threads, count, 256, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            int64_t low[3], high[3];
            float share[3];
            for (int c = 0; c < 3; c++) {
                const float end = static_cast<float>(size[c] - 1);
                float at = (positions[3 * k + c] - origin[c]) / spacing[c];
                at = at > 0.0f ? (at < end ? at : end) : 0.0f;
                low[c] = std::min(static_cast<int64_t>(at), std::max<int64_t>(size[c] - 2, 0));
                high[c] = std::min(low[c] + 1, size[c] - 1);
                share[c] = at - static_cast<float>(low[c]);
            }
            float* out = result + k * channels;
            memset(out, 0, static_cast<size_t>(channels) * sizeof(float));
            const float* n = normals + 3 * k;
            for (int corner = 0; corner < 8; corner++) {
                int64_t at[3];
                float weight = 1.0f;
                for (int c = 0; c < 3; c++) {
                    const bool upper = corner >> c & 1;
                    at[c] = upper ? high[c] : low[c];
                    weight *= upper ? share[c] : 1.0f - share[c];
                }
                if (weight == 0.0f) continue;
                const float* q = probes + ((at[2] * ny + at[1]) * nx + at[0]) * 4 * channels;
                for (int64_t c = 0; c < channels; c++) {
                    out[c] += weight * (q[c] + n[0] * q[channels + c] + n[1] * q[2 * channels + c] +
                                        n[2] * q[3 * channels + c]);
                }
            }
        }
    });
    return STATUS_OK;
}
