// Pictures of a rolling shutter: each row is drawn as the camera and what moves stood at its
// instant.
//
// Of each band of rows the parts and clusters are found once that any of them may see; the rows are
// then drawn one by one from these, by the same functions as a whole picture.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include "../abi.h"
#include "../threads.h"
#include "cluster_culling.h"
#include "record.h"
#include "render.h"

#define ROLLING_FIELDS(FIELD)                                                             \
    FIELD(sailenv::DrawingScratch**, scratch)                                             \
    FIELD(const sailenv::View*, view)                                                     \
    FIELD(const sailenv::Instances*, instances)                                           \
    FIELD(const sailenv::DrawList*, parts)                                                \
    FIELD(const sailenv::DrawList*, glass)                                                \
    FIELD(const sailenv::Light*, light)                                                   \
    FIELD(const sailenv::Outputs*, outputs)                                               \
    FIELD(int64_t, poses)                   /* as many as there are rows of the sensor */ \
    FIELD(int64_t, lines)                   /* rows of the picture to each of those */    \
    FIELD(const double*, camera_from_world) /* (poses, 4, 4) */                           \
    FIELD(const double*, world_from_camera) /* (poses, 4, 4) */                           \
    FIELD(int64_t, moving_count)                                                          \
    FIELD(const int64_t*, moving)           /* (moving_count,): rows of `instances` */    \
    FIELD(const double*, world_from_moving) /* (poses, moving_count, 4, 4) */

SAILENV_RECORD(Rolling, rolling_picture, ROLLING_FIELDS)

namespace sailenv {
namespace {

constexpr int64_t BAND_POSES = 32;
constexpr int64_t STILL = -1;
constexpr double LOOK_ROWS = 0.55;  // how far from its middle a row is looked at: smooth edges do
                                    // so half a row away, the rest is for roundings
constexpr double LEAST_DEPTH_M = 2e-3;  // of corners that have a row; more than the rasteriser's

// How far points move at most within a band: by `turn` times their distance from the eye, plus
// `shift` [m].
struct Bound {
    double turn, shift;
};

// A triangle of a band: its corners and vertices, and the rows that it may reach.
struct BandTriangle {
    uint32_t corner[3], vertex[3];
    int32_t low, high;
};

// Triangles of a band that lie in one cluster of the scene.
struct BandCluster {
    const Cluster* cluster;
    int64_t first, end;
};

// A part of the scene as a band sees it: with clusters, triangles and corners of its own.
struct BandPart {
    Part part;
    int64_t first_cluster, end_cluster, corner_at;
};

// Corners of a part that clusters which may be seen have, each once.
struct PartCorners {
    std::vector<int32_t> number_of;  // of each corner of the part, below; -1
    std::vector<uint32_t> corner;
    std::vector<float> x, y, z;
    std::vector<double> eye_x, eye_y, eye_z;  // as the eye has it at the band's middle
    std::vector<int32_t> low, high;           // rows that it may be in
    std::vector<int32_t> kept;                // number among those of the band's triangles; -1

    void begin(const Part& part) {
        for (const uint32_t before : corner) number_of[before] = -1;
        const size_t count = static_cast<size_t>(part.corner_count);
        if (number_of.size() < count) number_of.resize(count, -1);
        corner.clear();
    }
    void resize(size_t count) {
        for (std::vector<float>* axis : {&x, &y, &z}) axis->resize(count);
        for (std::vector<double>* axis : {&eye_x, &eye_y, &eye_z}) axis->resize(count);
        low.resize(count);
        high.resize(count);
        kept.resize(count);
    }
};

// The parts of a scene that a band may see, and their instances, numbered anew.
struct BandScene {
    std::vector<BandPart> opaque, glass;
    std::vector<BandCluster> clusters;
    std::vector<BandTriangle> triangles;
    std::vector<float> x, y, z;  // corners
    PartCorners corners;
    std::vector<int32_t> number_of;  // of each instance of the scene; -1
    std::vector<int64_t> moving_of;
    std::vector<double> poses, scales;
    std::vector<uint8_t> at_baked_pose;
};

// Some parts as some rows see them, as they are drawn.
struct RowScene {
    std::vector<Part> opaque, glass;
    std::vector<Cluster> clusters;
};

// Triangles of a part that one row may see, as numbers in `RowLists`.
struct RowPart {
    int64_t part, first, end;
};

// What each row of a band may see: triangles in their order, row after row.
struct RowLists {
    std::vector<uint32_t> corners, vertices;
    std::vector<int64_t> ends;  // of each row
    std::vector<std::vector<RowPart>> opaque, glass;
};

// The product of rigid transforms, rows of four.
void multiply(const double* a, const double* b, double* out) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            double sum = j == 3 ? a[4 * i + 3] : 0.0;
            for (int k = 0; k < 3; k++) sum += a[4 * i + k] * b[4 * k + j];
            out[4 * i + j] = sum;
        }
    }
}

void invert(const double* a, double* out) {
    for (int i = 0; i < 3; i++) {
        out[4 * i + 3] = 0.0;
        for (int j = 0; j < 3; j++) {
            out[4 * i + j] = a[4 * j + i];
            out[4 * i + 3] -= a[4 * j + i] * a[4 * j + 3];
        }
    }
}

// How points of the frame `from` move to that of the eye of another row.
void widen(Bound& bound, const double* eye_from_own, const double* own_from_eye) {
    double step[12], turn = 0.0, shift = 0.0;
    multiply(eye_from_own, own_from_eye, step);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const double x = step[4 * i + j] - (i == j ? 1.0 : 0.0);
            turn += x * x;
        }
        shift += step[4 * i + 3] * step[4 * i + 3];
    }
    bound.turn = std::max(bound.turn, std::sqrt(turn));
    bound.shift = std::max(bound.shift, std::sqrt(shift));
}

// Of a band: the pose at its middle and how far things move from there.
struct BandMotion {
    int64_t first, end, middle;
    Bound still;
    std::vector<Bound> moving;

    const Bound& of(int64_t moving_row) const {
        return moving_row == STILL ? still : moving[static_cast<size_t>(moving_row)];
    }
};

BandMotion motion_of(const Rolling& in, int64_t first, int64_t end) {
    BandMotion found{first, end, (first + end) / 2, {0.0, 0.0}, {}};
    const double* to_eye = in.camera_from_world + 16 * found.middle;
    for (int64_t row = first; row < end; row++) {
        widen(found.still, in.camera_from_world + 16 * row,
              in.world_from_camera + 16 * found.middle);
    }
    found.moving.assign(static_cast<size_t>(in.moving_count), Bound{0.0, 0.0});
    for (int64_t k = 0; k < in.moving_count; k++) {
        double eye_from_own[12], own_from_eye[12];
        multiply(to_eye, in.world_from_moving + 16 * (found.middle * in.moving_count + k),
                 eye_from_own);
        invert(eye_from_own, own_from_eye);
        for (int64_t row = first; row < end; row++) {
            multiply(in.camera_from_world + 16 * row,
                     in.world_from_moving + 16 * (row * in.moving_count + k), eye_from_own);
            widen(found.moving[static_cast<size_t>(k)], eye_from_own, own_from_eye);
        }
    }
    return found;
}

// A band that is prepared: the scene, its motion, and the eye's frames at the middle.
struct Band {
    const Rolling& in;
    const BandMotion& motion;
    const std::vector<int64_t>& moving_of;  // of each instance of the scene
    const Scratch& scratch;
    BandScene& scene;

    const InstanceFrame& frame(int64_t face, int64_t instance) const {
        return scratch.frames[static_cast<size_t>(face * in.instances->count + instance)];
    }

    // How far a point that distance [m] from the eye moves.
    double reach(int64_t instance, double distance) const {
        const Bound& bound = motion.of(moving_of[static_cast<size_t>(instance)]);
        return bound.turn * distance + bound.shift;
    }

    // Whether a sphere of an object's frame is seen in no row; and how far it moves.
    bool is_out(int64_t instance, const double* centre, double radius, double& moves) const {
        const double* m = frame(0, instance).eye_from_object;
        const double* scale = in.instances->scales + 3 * instance;
        double square = 0.0;
        for (int i = 0; i < 3; i++) {
            const double at = m[4 * i] * centre[0] + m[4 * i + 1] * centre[1] +
                              m[4 * i + 2] * centre[2] + m[4 * i + 3];
            square += at * at;
        }
        const double most = std::max({scale[0], scale[1], scale[2]});
        const double least = std::min({scale[0], scale[1], scale[2]});
        moves = reach(instance, std::sqrt(square) + most * radius) / least;
        const double wide = radius + moves;
        const LensTable* table = in.view->table;
        for (int32_t face = 0; face < (table == nullptr ? 1 : CUBE_FACES); face++) {
            if (table != nullptr && !is_used(table->faces[face])) continue;
            if (!is_beyond(centre, wide, frame(face, instance).sides)) return false;
        }
        return true;
    }
};

// Finds where the eye has corners, from number `first` on, and the rows that they may be in; all
// rows through a lens that bends lines.
void set_rows(const Band& band, int64_t instance, int64_t first, PartCorners& corners) {
    constexpr int32_t EVERY = 1 << 20;
    const int64_t count = static_cast<int64_t>(corners.corner.size());
    int32_t *lows = corners.low.data(), *highs = corners.high.data();
    if (band.in.view->table != nullptr) {
        std::fill(lows + first, lows + count, -EVERY);
        std::fill(highs + first, highs + count, EVERY);
        return;
    }
    const double* m = band.frame(0, instance).eye_from_object;
    const Bound bound = band.motion.of(band.moving_of[static_cast<size_t>(instance)]);
    const bool parallel = band.in.view->parallel != 0;
    const double fy = band.in.view->lens.fy, cy = band.in.view->lens.cy;
    const float *xs = corners.x.data(), *ys = corners.y.data(), *zs = corners.z.data();
    double *eye_x = corners.eye_x.data(), *eye_y = corners.eye_y.data(),
           *eye_z = corners.eye_z.data();
    for (int64_t k = first; k < count; k++) {
        const double a = xs[k], b = ys[k], c = zs[k];
        const double x = m[0] * a + m[1] * b + m[2] * c + m[3];
        const double y = m[4] * a + m[5] * b + m[6] * c + m[7];
        const double z = m[8] * a + m[9] * b + m[10] * c + m[11];
        eye_x[k] = x;
        eye_y[k] = y;
        eye_z[k] = z;
        const double reach = bound.turn * std::sqrt(x * x + y * y + z * z) + bound.shift;
        const double nearest = parallel ? 1.0 : z - reach;
        const double slope = parallel ? y : y / z;
        const double spread = parallel ? 1.0 : 1.0 + std::abs(slope);
        const double row = slope * fy + cy, margin = fy * reach * spread / nearest + LOOK_ROWS;
        const bool known =
            (nearest > LEAST_DEPTH_M) & (row - margin > -EVERY) & (row + margin < EVERY);
        lows[k] = static_cast<int32_t>(known ? std::ceil(row - margin) : -EVERY);
        highs[k] = static_cast<int32_t>(known ? std::floor(row + margin) : EVERY);
    }
}

// Whether a triangle shows its back in all rows, however its corners are rounded there.
bool shows_back(const PartCorners& corners, const int32_t* numbers, double shift) {
    constexpr double ROUNDING = 1e-6;
    double p[3][3];
    for (int j = 0; j < 3; j++) {
        const size_t k = static_cast<size_t>(numbers[j]);
        p[j][0] = corners.eye_x[k];
        p[j][1] = corners.eye_y[k];
        p[j][2] = corners.eye_z[k];
    }
    double normal[3] = {}, det = 0.0, across = 0.0, distance = 0.0;
    for (int j = 0; j < 3; j++) {
        const double *a = p[j], *b = p[(j + 1) % 3], *c = p[(j + 2) % 3];
        const double e[3] = {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2],
                             b[0] * c[1] - b[1] * c[0]};
        if (j == 0) det = a[0] * e[0] + a[1] * e[1] + a[2] * e[2];
        for (int i = 0; i < 3; i++) normal[i] += e[i];
        across += std::abs(e[0]) + std::abs(e[1]) + std::abs(e[2]);
        distance += std::abs(a[0]) + std::abs(a[1]) + std::abs(a[2]);
    }
    // To the triangle the eye moves by `shift` at most.
    const double size = std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2]);
    return det > shift * size + ROUNDING * distance * across;
}

int32_t number_of(const Band& band, int64_t instance) {
    const Instances& all = *band.in.instances;
    BandScene& scene = band.scene;
    int32_t& number = scene.number_of[static_cast<size_t>(instance)];
    if (number >= 0) return number;
    number = static_cast<int32_t>(scene.moving_of.size());
    scene.moving_of.push_back(band.moving_of[static_cast<size_t>(instance)]);
    const double *pose = all.world_from_body + 16 * instance, *scale = all.scales + 3 * instance;
    scene.poses.insert(scene.poses.end(), pose, pose + 16);
    scene.scales.insert(scene.scales.end(), scale, scale + 3);
    scene.at_baked_pose.push_back(all.at_baked_pose == nullptr ? uint8_t{0}
                                                               : all.at_baked_pose[instance]);
    return number;
}

// Keeps what the band's rows may see of a cluster.
void keep_triangles(const Band& band, const Part& part, const Cluster& cluster, bool one_sided,
                    int64_t corner_at, int32_t first_row, int32_t end_row) {
    BandScene& scene = band.scene;
    PartCorners& corners = scene.corners;
    const uint32_t* indices = part.corner_indices + cluster.first_index;
    const uint32_t* vertices = part.vertex_indices + cluster.first_index;
    const int64_t known = static_cast<int64_t>(corners.corner.size());
    for (int64_t k = 0; k < cluster.index_count; k++) {
        int32_t& number = corners.number_of[indices[k]];
        if (number >= 0) continue;
        number = static_cast<int32_t>(corners.corner.size());
        corners.corner.push_back(indices[k]);
    }
    const size_t count = corners.corner.size();
    if (corners.x.size() < count) corners.resize(2 * count);
    for (size_t k = static_cast<size_t>(known); k < count; k++) {
        corners.x[k] = part.corner_x[corners.corner[k]];
        corners.y[k] = part.corner_y[corners.corner[k]];
        corners.z[k] = part.corner_z[corners.corner[k]];
        corners.kept[k] = -1;
    }
    set_rows(band, part.instance, known, corners);
    const double shift = band.motion.of(band.moving_of[static_cast<size_t>(part.instance)]).shift;
    const int64_t begin = static_cast<int64_t>(scene.triangles.size());
    for (int64_t k = 0; k < cluster.index_count; k += 3) {
        int32_t numbers[3];
        BandTriangle t{{}, {}, 1 << 30, -(1 << 30)};
        for (int64_t j = 0; j < 3; j++) {
            numbers[j] = corners.number_of[indices[k + j]];
            t.vertex[j] = vertices[k + j];
            t.low = std::min(t.low, corners.low[static_cast<size_t>(numbers[j])]);
            t.high = std::max(t.high, corners.high[static_cast<size_t>(numbers[j])]);
        }
        t.low = std::max(t.low, first_row);
        t.high = std::min(t.high, end_row - 1);
        if (t.low > t.high || (one_sided && shows_back(corners, numbers, shift))) continue;
        for (int64_t j = 0; j < 3; j++) {
            const size_t at = static_cast<size_t>(numbers[j]);
            if (corners.kept[at] < 0) {
                corners.kept[at] =
                    static_cast<int32_t>(static_cast<int64_t>(scene.x.size()) - corner_at);
                scene.x.push_back(corners.x[at]);
                scene.y.push_back(corners.y[at]);
                scene.z.push_back(corners.z[at]);
            }
            t.corner[j] = static_cast<uint32_t>(corners.kept[at]);
        }
        scene.triangles.push_back(t);
    }
    const int64_t end = static_cast<int64_t>(scene.triangles.size());
    if (end > begin) scene.clusters.push_back({&cluster, begin, end});
}

void keep_seen(const Band& band, const DrawList& list, int32_t first_row, int32_t end_row,
               std::vector<BandPart>& kept) {
    const Instances& all = *band.in.instances;
    BandScene& scene = band.scene;
    // Where rays are parallel, what a turn lets them see of a cluster is not known.
    const bool has_eye = band.in.view->table == nullptr && band.in.view->parallel == 0;
    for (int64_t k = 0; k < list.count; k++) {
        const Part& part = list.parts[k];
        if (all.drawn != nullptr && !all.drawn[part.instance]) continue;
        const double centre[3] = {part.sphere[0], part.sphere[1], part.sphere[2]};
        double moves;
        if (band.is_out(part.instance, centre, part.sphere[3], moves)) continue;
        const bool two_sided = (part.flags & PART_DOUBLE_SIDED) != 0;
        const int64_t first_cluster = static_cast<int64_t>(scene.clusters.size());
        const int64_t corner_at = static_cast<int64_t>(scene.x.size());
        scene.corners.begin(part);
        for (int32_t c = 0; c < part.cluster_count; c++) {
            const Cluster& cluster = part.clusters[c];
            if (band.is_out(part.instance, cluster.centre, cluster.radius, moves)) continue;
            if (!two_sided && has_eye) {
                // To the cluster the eye moves as the cluster does to the eye.
                Cluster wide = cluster;
                wide.radius += moves;
                if (faces_away(wide, band.frame(0, part.instance).eye)) continue;
            }
            keep_triangles(band, part, cluster, !two_sided && has_eye, corner_at, first_row,
                           end_row);
        }
        const int64_t end_cluster = static_cast<int64_t>(scene.clusters.size());
        // Corners are read in steps of four, and written in steps of eight.
        const size_t padded = (scene.x.size() + 15) & ~size_t{7};
        for (std::vector<float>* axis : {&scene.x, &scene.y, &scene.z}) axis->resize(padded, 0.0f);
        if (end_cluster == first_cluster) continue;
        kept.push_back({part, first_cluster, end_cluster, corner_at});
        kept.back().part.instance = number_of(band, part.instance);
        kept.back().part.corner_count =
            static_cast<int32_t>(static_cast<int64_t>(padded) - 8 - corner_at);
    }
}

// Lists what each row may see, where a lens leaves lines straight.
void list_rows(const BandScene& scene, int32_t first_row, int32_t lines, int64_t rows,
               RowLists& lists) {
    std::vector<int64_t>& ends = lists.ends;
    ends.assign(static_cast<size_t>(rows) + 1, 0);
    // First how many more each row has than the one before.
    for (const BandTriangle& t : scene.triangles) {
        ends[static_cast<size_t>((t.low - first_row) / lines)]++;
        ends[static_cast<size_t>((t.high - first_row) / lines) + 1]--;
    }
    int64_t of_row = 0, listed = 0;
    for (int64_t row = 0; row < rows; row++) {
        of_row += ends[static_cast<size_t>(row)];
        ends[static_cast<size_t>(row)] = listed;
        listed += of_row;
    }
    lists.corners.resize(static_cast<size_t>(3 * listed));
    lists.vertices.resize(static_cast<size_t>(3 * listed));
    std::vector<int64_t> begun(ends);
    for (const bool see_through : {false, true}) {
        auto& listed_parts = see_through ? lists.glass : lists.opaque;
        listed_parts.resize(static_cast<size_t>(rows));
        for (auto& parts : listed_parts) parts.clear();
        const std::vector<BandPart>& parts = see_through ? scene.glass : scene.opaque;
        for (size_t p = 0; p < parts.size(); p++) {
            const size_t first = static_cast<size_t>(parts[p].first_cluster);
            const size_t last = static_cast<size_t>(parts[p].end_cluster) - 1;
            for (int64_t k = scene.clusters[first].first; k < scene.clusters[last].end; k++) {
                const BandTriangle& t = scene.triangles[static_cast<size_t>(k)];
                const int32_t low = (t.low - first_row) / lines;
                const int32_t high = (t.high - first_row) / lines;
                for (int32_t row = low; row <= high; row++) {
                    const int64_t at = 3 * ends[static_cast<size_t>(row)]++;
                    memcpy(lists.corners.data() + at, t.corner, sizeof t.corner);
                    memcpy(lists.vertices.data() + at, t.vertex, sizeof t.vertex);
                }
            }
            for (size_t row = 0; row < static_cast<size_t>(rows); row++) {
                if (ends[row] == begun[row]) continue;
                listed_parts[row].push_back({static_cast<int64_t>(p), begun[row], ends[row]});
                begun[row] = ends[row];
            }
        }
    }
}

// A part as it is drawn, with clusters yet to come.
Part drawn_part(const BandScene& scene, const BandPart& part, const RowLists& lists,
                int64_t clusters) {
    Part drawn = part.part;
    drawn.cluster_count = static_cast<int32_t>(clusters);
    drawn.corner_x = scene.x.data() + part.corner_at;
    drawn.corner_y = scene.y.data() + part.corner_at;
    drawn.corner_z = scene.z.data() + part.corner_at;
    drawn.corner_indices = lists.corners.data();
    drawn.vertex_indices = lists.vertices.data();
    return drawn;
}

void point_to_clusters(RowScene& row) {
    // Where the clusters lie is known when all are there.
    const Cluster* clusters = row.clusters.data();
    for (std::vector<Part>* list : {&row.opaque, &row.glass}) {
        for (Part& part : *list) {
            part.clusters = clusters;
            clusters += part.cluster_count;
        }
    }
}

// What a row may see; its triangles fill clusters of which nothing is known.
void set_row_scene(const BandScene& scene, const RowLists& lists, size_t number, RowScene& row) {
    row.clusters.clear();
    for (const bool see_through : {false, true}) {
        const std::vector<BandPart>& parts = see_through ? scene.glass : scene.opaque;
        std::vector<Part>& drawn = see_through ? row.glass : row.opaque;
        drawn.clear();
        for (const RowPart& p : (see_through ? lists.glass : lists.opaque)[number]) {
            const size_t begun = row.clusters.size();
            for (int64_t k = p.first; k < p.end; k += CLUSTER_TRIANGLES) {
                row.clusters.emplace_back();
                row.clusters.back().first_index = 3 * k;
                row.clusters.back().index_count =
                    3 * std::min<int64_t>(CLUSTER_TRIANGLES, p.end - k);
            }
            const int64_t clusters = static_cast<int64_t>(row.clusters.size() - begun);
            drawn.push_back(drawn_part(scene, parts[static_cast<size_t>(p.part)], lists, clusters));
        }
    }
    point_to_clusters(row);
}

// What all rows of a band may see, in the clusters of the scene.
void set_band_scene(const BandScene& scene, RowLists& lists, RowScene& rows) {
    lists.corners.clear();
    lists.vertices.clear();
    rows.clusters.clear();
    for (const BandCluster& cluster : scene.clusters) {
        rows.clusters.push_back(*cluster.cluster);
        rows.clusters.back().first_index = static_cast<int64_t>(lists.corners.size());
        rows.clusters.back().index_count = 3 * (cluster.end - cluster.first);
        for (int64_t k = cluster.first; k < cluster.end; k++) {
            const BandTriangle& t = scene.triangles[static_cast<size_t>(k)];
            lists.corners.insert(lists.corners.end(), t.corner, t.corner + 3);
            lists.vertices.insert(lists.vertices.end(), t.vertex, t.vertex + 3);
        }
    }
    for (const bool see_through : {false, true}) {
        std::vector<Part>& drawn = see_through ? rows.glass : rows.opaque;
        drawn.clear();
        for (const BandPart& part : see_through ? scene.glass : scene.opaque) {
            const int64_t clusters = part.end_cluster - part.first_cluster;
            drawn.push_back(drawn_part(scene, part, lists, clusters));
        }
    }
    point_to_clusters(rows);
}

void draw_rolling_band(const Rolling& in, int64_t first, int64_t end,
                       const std::vector<int64_t>& moving_of, DrawingScratch& scratch) {
    const BandMotion motion = motion_of(in, first, end);
    const int32_t lines = static_cast<int32_t>(in.lines);
    const int32_t first_row = static_cast<int32_t>(first) * lines;
    const int32_t end_row = static_cast<int32_t>(end) * lines;
    View view = *in.view;
    const auto stand_at = [&](int64_t row) {
        std::copy_n(in.camera_from_world + 16 * row, 16, view.camera_from_world);
        std::copy_n(in.world_from_camera + 16 * row, 16, view.world_from_camera);
    };
    // What the band may see, from where things stand at its middle.
    stand_at(motion.middle);
    Projection projection = projection_of(view);
    projection.y0 = first_row;
    projection.y1 = end_row - 1;
    Instances instances = *in.instances;
    instances.clipped = 0;
    std::vector<double> poses(instances.world_from_body,
                              instances.world_from_body + 16 * instances.count);
    for (int64_t k = 0; k < in.moving_count; k++) {
        std::copy_n(in.world_from_moving + 16 * (motion.middle * in.moving_count + k), 16,
                    poses.data() + 16 * in.moving[k]);
    }
    instances.world_from_body = poses.data();
    set_frames(scratch, instances, view.camera_from_world, projection);
    BandScene scene;
    scene.number_of.assign(static_cast<size_t>(instances.count), -1);
    const Band band{in, motion, moving_of, scratch, scene};
    keep_seen(band, *in.parts, first_row, end_row, scene.opaque);
    if (in.outputs->radiance != nullptr) {
        keep_seen(band, *in.glass, first_row, end_row, scene.glass);
    }
    Instances seen{};
    seen.world_from_body = scene.poses.data();
    seen.scales = scene.scales.data();
    seen.at_baked_pose = scene.at_baked_pose.data();
    seen.count = static_cast<int64_t>(scene.moving_of.size());
    const bool straight = view.table == nullptr;
    RowScene listed;
    RowLists lists;
    if (straight) {
        list_rows(scene, first_row, lines, end - first, lists);
    } else {
        set_band_scene(scene, lists, listed);
    }
    for (int64_t row = first; row < end; row++) {
        stand_at(row);
        for (size_t k = 0; k < scene.moving_of.size(); k++) {
            if (scene.moving_of[k] == STILL) continue;
            std::copy_n(in.world_from_moving + 16 * (row * in.moving_count + scene.moving_of[k]),
                        16, scene.poses.data() + 16 * k);
        }
        const int32_t top = static_cast<int32_t>(row) * lines;
        if (straight) set_row_scene(scene, lists, static_cast<size_t>(row - first), listed);
        const DrawList parts{listed.opaque.data(), static_cast<int64_t>(listed.opaque.size())};
        const DrawList glass{listed.glass.data(), static_cast<int64_t>(listed.glass.size())};
        draw_rows(1, scratch, view, seen, parts, glass, in.light, *in.outputs,
                  {top, top + lines, lines, straight});
    }
}

bool is_valid(const Rolling& in) {
    if (!is_drawable(*in.view, in.light, *in.outputs) || in.poses < 1 || in.lines < 1) return false;
    if (in.lines > in.view->height || in.poses > in.view->height) return false;
    if (in.poses * in.lines != in.view->height || in.moving_count < 0) return false;
    for (int64_t k = 0; k < in.moving_count; k++) {
        if (in.moving[k] < 0 || in.moving[k] >= in.instances->count) return false;
    }
    return true;
}

}  // namespace
}  // namespace sailenv

// Draws what one camera with a rolling shutter sees.
SAILENV_KERNEL(rolling_picture)(int64_t threads, const Rolling* given) {
    using namespace sailenv;
    const Rolling& in = *given;
    if (!is_valid(in)) return STATUS_INVALID_ARGUMENT;
    try {
        auto& slots = (*in.scratch)->of_slots;
        const size_t wanted = static_cast<size_t>(std::max<int64_t>(threads, 1));
        while (slots.size() < wanted) slots.push_back(std::make_unique<DrawingScratch>());
        std::vector<int64_t> moving_of(static_cast<size_t>(in.instances->count), STILL);
        for (int64_t k = 0; k < in.moving_count; k++) {
            moving_of[static_cast<size_t>(in.moving[k])] = k;
        }
        parallel_for(threads, in.poses, BAND_POSES, [&](int64_t first, int64_t end, int64_t slot) {
            draw_rolling_band(in, first, end, moving_of, *slots[static_cast<size_t>(slot)]);
        });
    } catch (const std::bad_alloc&) {
        return STATUS_OUT_OF_MEMORY;
    }
    return STATUS_OK;
}
