// Edges of surfaces: visibility is known at six samples of each pixel, light is worked out once for
// each surface that they see.
//
// Two samples lie in the pixel's square and count a quarter: its middle, and one above and to the
// left. Four lie on its sides and count an eighth, as they are of the pixels beside, too. See
// SAMPLE_SHIFT. Samples that see one smooth surface share their light.
#include "edges.h"

#include <algorithm>

#include "ambient_share.h"

namespace sailenv {
namespace {

constexpr int32_t SAMPLES = 6;
constexpr float LEAST_COSINE = 0.9f;         // between normals within one smooth surface
constexpr float SAME_INVERSE_DEPTH = 0.01f;  // as a share, within one smooth surface
// By how much samples half a pixel to both sides may lie off the plane through the middle, as a
// share of its inverse_depth and over the focal length: 3 degrees of bend or so, or a sharper one
// near the pixel's rim.
constexpr float LEAST_BEND = 0.03f;
// Where rays are parallel, a bend is compared with a pixel's side, and depths within one smooth
// surface differ by at most so many of these: as at a focal length of 500 px.
constexpr float SAME_DEPTH_PX = 5.0f;
constexpr float LEAST_HEIGHT_PX = 2.0f;  // of a triangle over the edge that ends a surface

// Column, row, weight; and where they are from the middle of the pixel [pixels].
struct Sample {
    int32_t column, row;
    float weight;

    constexpr float x() const {
        return 0.5f * static_cast<float>(column - 1) + (row % 2 == 0 ? SAMPLE_SHIFT : 0.0f);
    }
    constexpr float y() const {
        return 0.5f * static_cast<float>(row - 1) + (column % 2 == 0 ? SAMPLE_SHIFT : 0.0f);
    }
};
constexpr Sample PATTERN[SAMPLES] = {{1, 1, 0.25f},  {1, 0, 0.125f}, {0, 1, 0.125f},
                                     {2, 1, 0.125f}, {1, 2, 0.125f}, {0, 0, 0.25f}};

// The samples around the middle: where they are from it [pixels], and a bit for each; then none.
struct SamplesAround {
    alignas(32) float x[8], y[8];
    alignas(32) int32_t bit[8];
};
constexpr SamplesAround samples_around() {
    SamplesAround found{};
    for (int32_t k = 1; k < SAMPLES; k++) {
        found.x[k - 1] = PATTERN[k].x();
        found.y[k - 1] = PATTERN[k].y();
        found.bit[k - 1] = 1 << k;
    }
    return found;
}
constexpr SamplesAround AROUND = samples_around();

// The plane of a triangle; `normal` has any length. 1 / depth is the ray's share along the plane's
// normal, so its slopes are the normal; those of -depth are, where it is 1 along the axis.
struct Plane {
    vec3 normal;
    float square;
};
LANES_INLINE Plane plane_of(const Shading& s, const Triangle& t) {
    vec3 normal = s.lens.direction(t.inverse_depth);
    if (s.sight == Sight::PARALLEL) normal.z = 1.0f;
    // A face that is alone has the camera's frame.
    if (s.table != nullptr && s.table->several) normal = s.camera_from_face[t.face] * normal;
    return {normal, dot(normal, normal)};
}

// Tells if two triangles belong to one smooth surface around a place, which is one of the second's
// face.
LANES_INLINE bool are_alike(const Shading& s, const Triangle& a, const Plane& p, const Triangle& b,
                            const Plane& q, float x, float y) {
    if (a.part != b.part) return false;
    const float there = b.inverse_depth[0] * x + (b.inverse_depth[1] * y + b.inverse_depth[2]);
    const float other = a.face == b.face
                            ? a.inverse_depth[0] * x + (a.inverse_depth[1] * y + a.inverse_depth[2])
                            : dot(p.normal, ray_at(s.camera_from_face[b.face], x, y));
    const float off = other - there;
    const float most =
        s.sight == Sight::PARALLEL ? ray_length(s.lens, SAME_DEPTH_PX) : SAME_INVERSE_DEPTH * there;
    if (__builtin_fabsf(off) > most) return false;
    const float along = dot(p.normal, q.normal);
    return along > 0.0f && along * along >= LEAST_COSINE * LEAST_COSINE * (p.square * q.square);
}

// A surface that samples of a pixel see: its first one, and the weight of all.
struct Seen {
    uint32_t tag;
    int32_t face;
    float x, y, weight;
    const Triangle* triangle;  // null for nothing
    Plane plane;
};

// What a sample of a pixel sees, with no weight yet; x is not a number where the lens sees nothing.
LANES_INLINE Seen seen_at(const Shading& s, uint32_t tag, int32_t x, int32_t y,
                          const Sample& sample) {
    Seen own = {
        tag,     0, static_cast<float>(x) + sample.x(), static_cast<float>(y) + sample.y(), 0.0f,
        nullptr, {}};
    if (s.table != nullptr) {
        const LensTable& lens = *s.fine_table;
        const int64_t at = (2 * y + sample.row) * lens.stride + 2 * x + sample.column;
        own.x = lens.x[at];
        own.y = lens.y[at];
        own.face = lens.several ? lens.face[at] : 0;
    }
    if (tag != NOTHING) {
        own.triangle = s.set->triangles.data() + tag;
        own.plane = plane_of(s, *own.triangle);
    }
    return own;
}

// Tells if two samples see one smooth surface.
LANES_INLINE bool are_alike(const Shading& s, const Seen& a, const Seen& b) {
    return a.triangle != nullptr && b.triangle != nullptr &&
           are_alike(s, *a.triangle, a.plane, *b.triangle, b.plane, b.x, b.y);
}

// The middle of a pixel, and how places change from pixel to pixel.
struct Middle {
    float x, y;
    float x_right, y_right, x_down, y_down;
    int32_t face;
};
Middle middle_of(const Shading& s, int32_t x, int32_t y) {
    if (s.table == nullptr) {
        return {static_cast<float>(x), static_cast<float>(y), 1.0f, 0.0f, 0.0f, 1.0f, 0};
    }
    // The centre is among the fine samples, which were looked at just now.
    const LensTable& lens = *s.fine_table;
    const int64_t at = (2 * y + 1) * lens.stride + 2 * x + 1;
    const PixelStep steps = step_at(*s.table, y, x);
    return {lens.x[at],
            lens.y[at],
            steps.x_right,
            steps.y_right,
            steps.x_down,
            steps.y_down,
            lens.several ? lens.face[at] : 0};
}

// A function a x + b y + c of the place in a pixel, whose middle is the origin. Through a lens that
// bends lines they are straight within a pixel.
struct Line {
    float a, b, c;
};
LANES_INLINE Line line_at(const float* plane, const Middle& m, float sign) {
    return {sign * (plane[0] * m.x_right + plane[1] * m.y_right),
            sign * (plane[0] * m.x_down + plane[1] * m.y_down),
            sign * (plane[0] * m.x + (plane[1] * m.y + plane[2]))};
}

// Share of the pixel's square where the line's function is above 0.
float share_above(const Line& line) {
    const float a = __builtin_fabsf(line.a), b = __builtin_fabsf(line.b);
    const float steep = a > b ? a : b, flat = a > b ? b : a, off = __builtin_fabsf(line.c);
    float beyond = 0.0f;  // the smaller part
    if (2.0f * off <= steep - flat) {
        beyond = 0.5f - off / steep;
    } else if (2.0f * off < steep + flat) {
        const float leg = 0.5f * (steep + flat) - off;
        beyond = leg * leg / (2.0f * steep * flat);
    }
    return line.c > 0.0f ? 1.0f - beyond : beyond;
}

// Which samples see the second of two surfaces: a bit for each. The centre, the first one, sees the
// first.
using SecondSeen = uint32_t;

// Tells if the line lies between the samples of one surface, where it is at most 0, and those of
// the other.
LANES_INLINE bool separates(const Line& line, SecondSeen second) {
    const float margin = 0.01f * (__builtin_fabsf(line.a) + __builtin_fabsf(line.b));
    if (!(margin > 0.0f) || line.c > margin) return false;
    const i8 is_second = (splat(static_cast<int32_t>(second)) & load(AROUND.bit)) != 0;
    const f8 value = line.a * load(AROUND.x) + line.b * load(AROUND.y) + line.c;
    return !any(negated_if(value, is_second) > margin);
}

// The most that a surface covers of a pixel if one of its triangle's edges ends it: edges within
// the surface leave less. Below 0 if none lies between the samples. Of small or thin triangles
// others may lie between them and the surface's end. `inside` is 1 for the second surface, -1 for
// the first one.
float share_within(const Shading& s, const Triangle& t, SecondSeen second, const Middle& middle,
                   float inside) {
    float most = -1.0f;
    // At the opposite corner an edge's function is this, if the triangle's depth varies little.
    const float over =
        s.sight == Sight::PARALLEL
            ? 1.0f
            : t.inverse_depth[0] * middle.x + (t.inverse_depth[1] * middle.y + t.inverse_depth[2]);
    const float opposite = over / t.inverse_det;
    for (int32_t j = 0; j < 3; j++) {
        const Line line = line_at(t.edge + 3 * j, middle, inside);
        const float slope = line.a * line.a + line.b * line.b;
        const bool high = opposite * opposite >= LEAST_HEIGHT_PX * LEAST_HEIGHT_PX * slope;
        if (!high || !separates(line, second)) continue;
        const float share = share_above(line);
        most = std::max(most, inside > 0.0f ? share : 1.0f - share);
    }
    return most;
}

// Share of a pixel that the second of two surfaces covers where a straight edge of one of them
// ends it, or where both meet; below 0 if neither is so.
float exact_share(const Shading& s, const Triangle* first, const Triangle* second,
                  SecondSeen second_seen, const Middle& middle) {
    for (const Triangle* t : {first, second}) {
        if (t != nullptr && t->face != middle.face) return -1.0f;
    }
    const Line empty = {0.0f, 0.0f, s.sight == Sight::PARALLEL ? -__builtin_inff() : -1.0f};
    const Line a = first == nullptr ? empty : line_at(first->inverse_depth, middle, 1.0f);
    const Line b = second == nullptr ? empty : line_at(second->inverse_depth, middle, 1.0f);
    // What is in front ends the other.
    const bool second_first = b.c > a.c;
    for (const bool of_second : {second_first, !second_first}) {
        const Triangle* t = of_second ? second : first;
        if (t == nullptr) continue;
        const float share = share_within(s, *t, second_seen, middle, of_second ? 1.0f : -1.0f);
        if (share >= 0.0f) return of_second ? share : 1.0f - share;
    }
    if (first == nullptr || second == nullptr) return -1.0f;
    const Line meeting = {b.a - a.a, b.b - a.b, b.c - a.c};
    if (separates(meeting, second_seen)) return share_above(meeting);
    const Line other = {-meeting.a, -meeting.b, -meeting.c};
    return separates(other, second_seen) ? share_above(other) : -1.0f;
}

// Lists what a pixel's samples see besides what its centre sees. `fine` begins at its first sample.
void list_fragments(const Shading& s, const EdgeScratch& scratch, const uint32_t* fine, int32_t x,
                    int32_t y, std::vector<Fragment>& out) {
    Seen seen[SAMPLES];
    int32_t surface[SAMPLES];
    int32_t count = 0;
    uint32_t last = 0;  // the tag that was found last to be of a surface of another tag
    int32_t last_surface = -1;
    for (int32_t number = 0; number < SAMPLES; number++) {
        const Sample& sample = PATTERN[number];
        const uint32_t tag = fine[sample.row * scratch.stride + sample.column];
        int32_t k = 0;
        while (k < count && seen[k].tag != tag) k++;
        if (k == count && last_surface >= 0 && tag == last) k = last_surface;
        if (k == count) {
            const Seen own = seen_at(s, tag, x, y, sample);
            if (!(own.x == own.x)) {
                // What the lens does not see counts as what it sees beside it.
                if (number == 0) return;
                surface[number] = 0;
                continue;
            }
            for (k = 0; k < count; k++) {
                if (are_alike(s, seen[k], own)) break;
            }
            seen[count] = own;
            if (k == count) {
                count++;
            } else {
                last = tag;
                last_surface = k;
            }
        }
        seen[k].weight += sample.weight;
        surface[number] = k;
    }
    if (count == 2) {
        SecondSeen second = 0;
        for (int32_t k = 0; k < SAMPLES; k++) second |= static_cast<uint32_t>(surface[k]) << k;
        const float share =
            exact_share(s, seen[0].triangle, seen[1].triangle, second, middle_of(s, x, y));
        if (share >= 0.0f) seen[1].weight = share;
    }
    for (int32_t k = 1; k < count; k++) {
        out.push_back({seen[k].x, seen[k].y, seen[k].weight, seen[k].tag, x, y, seen[k].face});
    }
}

// The same of a pixel whose samples see two triangles, or one and nothing; false where the lens
// does not see the first sample of either.
bool list_pair(const Shading& s, uint32_t tag, uint32_t other, SecondSeen second, int32_t x,
               int32_t y, std::vector<Fragment>& out) {
    const Seen own = seen_at(s, tag, x, y, PATTERN[0]);
    const Seen beside = seen_at(s, other, x, y, PATTERN[__builtin_ctz(second)]);
    if (!(own.x == own.x && beside.x == beside.x)) return false;
    if (are_alike(s, own, beside)) return true;
    float weight = exact_share(s, own.triangle, beside.triangle, second, middle_of(s, x, y));
    if (weight < 0.0f) {
        weight = 0.0f;
        for (; second != 0; second &= second - 1) {
            weight += PATTERN[__builtin_ctz(second)].weight;
        }
    }
    out.push_back({beside.x, beside.y, weight, other, x, y, beside.face});
    return true;
}

// Of which of eight pixels the samples do not lie in one plane. `corner` is their first sample.
LANES_INLINE i8 bent(const Shading& s, const float* corner, int64_t stride, int32_t x, int32_t y) {
    const float* middle = corner + stride + 1;
    const f8 own = every_second(middle);
    const f8 scale = s.sight == Sight::PARALLEL ? splat(1.0f) : own;
    f8 least = scale * (ray_length(s.lens, LEAST_BEND));
    if (s.table != nullptr) {
        const LensSteps steps = steps_at(*s.table, y, x);
        least = least * sqrt8(steps.x_right * steps.x_right + steps.y_right * steps.y_right);
    }
    const f8 left = every_second(middle - 1), right = every_second(middle + 1),
             top = every_second(middle - stride), bottom = every_second(middle + stride),
             inner = every_second(corner);
    // Over a plane samples differ by where they lie from the middle.
    constexpr float TWICE = 2.0f * SAMPLE_SHIFT;
    const f8 across = right - left, down = bottom - top;
    return (abs8(left + right - (own + own) - TWICE * down) > least) |
           (abs8(top + bottom - (own + own) - TWICE * across) > least) |
           (abs8(2.0f * (inner - own) + (1.0f - TWICE) * (across + down)) > least);
}

// Tells if a pixel's samples see triangles of one part. `fine` begins at its first sample.
bool sees_one_part(const Shading& s, const uint32_t* fine, int64_t stride) {
    const uint32_t middle = fine[stride + 1];
    for (const Sample& sample : PATTERN) {
        const uint32_t tag = fine[sample.row * stride + sample.column];
        if (tag == middle) continue;
        if (tag == NOTHING || middle == NOTHING) return false;
        if (s.set->part_of[tag] != s.set->part_of[middle]) return false;
    }
    return true;
}

}  // namespace

void list_edges(const Shading& s, int32_t first_row, int32_t last_row, const EdgeScratch& scratch,
                BandEdges& edges) {
    edges.fragments.clear();
    const int64_t stride = scratch.stride;
    for (int32_t y = first_row; y < last_row; y++) {
        const uint32_t* top = scratch.visible.data() + 2 * (y - first_row) * stride;
        for (int32_t x = 0; x < s.width; x += 8) {
            const uint32_t* corner = top + 2 * x;
            i8 seen[SAMPLES], differs{};
            for (int32_t k = 0; k < SAMPLES; k++) {
                seen[k] = every_second(corner + PATTERN[k].row * stride + PATTERN[k].column);
                differs |= seen[k] ^ seen[0];
            }
            if (!any(differs)) continue;
            i8 other = seen[0], second{}, more{};
            for (int32_t k = SAMPLES - 1; k > 0; k--) other = seen[k] != seen[0] ? seen[k] : other;
            for (int32_t k = 1; k < SAMPLES; k++) {
                const i8 is_other = seen[k] == other;
                second |= is_other & (1 << k);
                more |= ~is_other & (seen[k] ^ seen[0]);
            }
            const int64_t at = corner - scratch.visible.data();
            const i8 bends = bent(s, scratch.inverse_depth.data() + at, stride, x, y);
            const int32_t rest = static_cast<int32_t>(s.width) - x, count = rest < 8 ? rest : 8;
            for (int32_t k = 0; k < count; k++) {
                if (differs[k] == 0) continue;
                const uint32_t* fine = corner + 2 * k;
                if (bends[k] == 0 && sees_one_part(s, fine, stride)) continue;
                if (more[k] == 0 &&
                    list_pair(s, static_cast<uint32_t>(seen[0][k]), static_cast<uint32_t>(other[k]),
                              static_cast<uint32_t>(second[k]), x + k, y, edges.fragments)) {
                    continue;
                }
                list_fragments(s, scratch, fine, x + k, y, edges.fragments);
            }
        }
    }
}

void smooth_edges(const Shading& s, BandEdges& edges) {
    const std::vector<Fragment>& fragments = edges.fragments;
    edges.light.resize(4 * fragments.size());
    shade_fragments(s, fragments.data(), static_cast<int64_t>(fragments.size()),
                    edges.light.data());
    for (size_t k = 0; k < fragments.size();) {
        const int32_t x = fragments[k].pixel_x, y = fragments[k].pixel_y;
        uint16_t* pixel = s.outputs->radiance + 4 * (y * s.width + x);
        float sum[4] = {}, rest = 1.0f;
        for (; k < fragments.size() && fragments[k].pixel_x == x && fragments[k].pixel_y == y;
             k++) {
            rest -= fragments[k].weight;
            for (size_t c = 0; c < 4; c++) {
                sum[c] += fragments[k].weight * small_number(edges.light[4 * k + c]);
            }
        }
        for (int c = 0; c < 4; c++) {
            const float mean = rest * small_number(pixel[c]) + sum[c];
            int32_t shifted;
            memcpy(&shifted, &mean, sizeof shifted);
            pixel[c] = static_cast<uint16_t>((shifted + 4096) >> 13);
        }
    }
}

int64_t fine_stride(int64_t width) {
    return (2 * width + 1 + ROW_PADDING + 16 + 15) & ~int64_t{15};
}

void take_centres(const uint32_t* fine, int64_t width, uint32_t* pixels) {
    for (int64_t x = 0; x < width; x += 8) {
        store(reinterpret_cast<int32_t*>(pixels + x), every_second(fine + 2 * x + 1));
    }
}

void take_centres(const float* fine, int64_t width, float* pixels) {
    for (int64_t x = 0; x < width; x += 8) store(pixels + x, every_second(fine + 2 * x + 1));
}

}  // namespace sailenv
