// Pictures of a rolling shutter: each row is drawn as the camera and what moves stood at its
// instant.
//
// Of each band of rows the parts and clusters are found once that any of them may see; the rows are
// then drawn one by one from these, by the same functions as a whole picture.
#include <algorithm>
#include <cmath>
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
constexpr int64_t MOST_INDICES = 3 * CLUSTER_TRIANGLES;
constexpr int64_t STILL = -1;
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

// Triangles of a band that lie in one cluster of the scene, and the rows that they may reach.
struct BandCluster {
    const Cluster* cluster;
    int64_t first, end;
    int32_t low, high;
};

// A part of the scene as a band sees it: with clusters, triangles and corners of its own.
struct BandPart {
    Part part;
    int64_t first_cluster, end_cluster, corner_at;
};

// The parts of a scene that a band may see, and their instances, numbered anew.
struct BandScene {
    std::vector<BandPart> opaque, glass;
    std::vector<BandCluster> clusters;
    std::vector<BandTriangle> triangles;
    std::vector<float> x, y, z;      // corners
    std::vector<int32_t> low, high;  // rows of each
    std::vector<int32_t> corner_of;  // number of a part's corner in the band; -1
    std::vector<int32_t> number_of;  // of each instance of the scene; -1
    std::vector<int64_t> moving_of;
    std::vector<double> poses, scales;
    std::vector<uint8_t> at_baked_pose;
};

// The same as one row sees it, as it is drawn.
struct RowScene {
    std::vector<Part> opaque, glass;
    std::vector<Cluster> clusters;
    std::vector<uint32_t> corners, vertices;
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

// Finds the rows that a corner may be in; all of them through a lens that bends lines.
void set_rows(const Band& band, int64_t instance, const float* corner, int32_t& low,
              int32_t& high) {
    constexpr int32_t EVERY = 1 << 20;
    low = -EVERY;
    high = EVERY;
    if (band.in.view->table != nullptr) return;
    const double* m = band.frame(0, instance).eye_from_object;
    double at[3];
    for (int i = 0; i < 3; i++) {
        at[i] = m[4 * i] * corner[0] + m[4 * i + 1] * corner[1] + m[4 * i + 2] * corner[2] +
                m[4 * i + 3];
    }
    const double distance = std::sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
    const double reach = band.reach(instance, distance);
    const bool parallel = band.in.view->parallel != 0;
    const double nearest = parallel ? 1.0 : at[2] - reach;
    if (!(nearest > LEAST_DEPTH_M)) return;
    const Lens& lens = band.in.view->lens;
    const double slope = parallel ? at[1] : at[1] / at[2];
    const double row = slope * lens.fy + lens.cy;
    // Besides, smooth edges look half a row away.
    const double spread = parallel ? 1.0 : 1.0 + std::abs(slope);
    const double margin = lens.fy * reach * spread / nearest + 1.0;
    if (!(row - margin > -EVERY && row + margin < EVERY)) return;
    low = static_cast<int32_t>(std::floor(row - margin));
    high = static_cast<int32_t>(std::ceil(row + margin));
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
void keep_triangles(const Band& band, const Part& part, const Cluster& cluster, int64_t corner_at,
                    int32_t first_row, int32_t end_row) {
    BandScene& scene = band.scene;
    const int64_t begin = static_cast<int64_t>(scene.triangles.size());
    for (int64_t k = 0; k < cluster.index_count; k += 3) {
        BandTriangle t{{}, {}, 1 << 30, -(1 << 30)};
        for (int64_t j = 0; j < 3; j++) {
            const uint32_t corner = part.corner_indices[cluster.first_index + k + j];
            int32_t& number = scene.corner_of[corner];
            if (number < 0) {
                number = static_cast<int32_t>(static_cast<int64_t>(scene.x.size()) - corner_at);
                const float place[3] = {part.corner_x[corner], part.corner_y[corner],
                                        part.corner_z[corner]};
                int32_t low, high;
                set_rows(band, part.instance, place, low, high);
                scene.x.push_back(place[0]);
                scene.y.push_back(place[1]);
                scene.z.push_back(place[2]);
                scene.low.push_back(low);
                scene.high.push_back(high);
            }
            t.corner[j] = static_cast<uint32_t>(number);
            t.vertex[j] = part.vertex_indices[cluster.first_index + k + j];
            t.low = std::min(t.low, scene.low[static_cast<size_t>(corner_at + number)]);
            t.high = std::max(t.high, scene.high[static_cast<size_t>(corner_at + number)]);
        }
        if (t.low < end_row && t.high >= first_row) scene.triangles.push_back(t);
    }
    const int64_t end = static_cast<int64_t>(scene.triangles.size());
    if (end == begin) return;
    BandCluster kept{&cluster, begin, end, 1 << 30, -(1 << 30)};
    for (int64_t k = begin; k < end; k++) {
        kept.low = std::min(kept.low, scene.triangles[static_cast<size_t>(k)].low);
        kept.high = std::max(kept.high, scene.triangles[static_cast<size_t>(k)].high);
    }
    scene.clusters.push_back(kept);
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
        scene.corner_of.assign(static_cast<size_t>(part.corner_count), -1);
        for (int32_t c = 0; c < part.cluster_count; c++) {
            const Cluster& cluster = part.clusters[c];
            if (band.is_out(part.instance, cluster.centre, cluster.radius, moves)) continue;
            if (!two_sided && has_eye) {
                // To the cluster the eye moves as the cluster does to the eye.
                Cluster wide = cluster;
                wide.radius += moves;
                if (faces_away(wide, band.frame(0, part.instance).eye)) continue;
            }
            keep_triangles(band, part, cluster, corner_at, first_row, end_row);
        }
        const int64_t end_cluster = static_cast<int64_t>(scene.clusters.size());
        // Corners are read in steps of four, and written in steps of eight.
        const size_t padded = (scene.x.size() + 15) & ~size_t{7};
        for (std::vector<float>* axis : {&scene.x, &scene.y, &scene.z}) axis->resize(padded, 0.0f);
        scene.low.resize(padded, 0);
        scene.high.resize(padded, 0);
        if (end_cluster == first_cluster) continue;
        kept.push_back({part, first_cluster, end_cluster, corner_at});
        kept.back().part.instance = number_of(band, part.instance);
        kept.back().part.corner_count =
            static_cast<int32_t>(static_cast<int64_t>(padded) - 8 - corner_at);
    }
}

// Lists what some rows may see. Through a lens that leaves lines straight, triangles that may lie
// in these rows fill clusters of their own, of which nothing is known.
void list_rows(const BandScene& scene, bool straight, int32_t first_row, int32_t last_row,
               RowScene& row) {
    row.clusters.clear();
    // Room for all; as many as are listed count.
    row.corners.resize(3 * scene.triangles.size());
    row.vertices.resize(3 * scene.triangles.size());
    uint32_t *corners = row.corners.data(), *vertices = row.vertices.data();
    int64_t listed_indices = 0;
    Cluster anywhere{};
    anywhere.radius = 1e30;
    for (const bool see_through : {false, true}) {
        std::vector<Part>& listed = see_through ? row.glass : row.opaque;
        listed.clear();
        for (const BandPart& part : see_through ? scene.glass : scene.opaque) {
            const size_t begun = row.clusters.size();
            const auto begin_cluster = [&](const Cluster& like) {
                row.clusters.push_back(like);
                row.clusters.back().first_index = listed_indices;
                row.clusters.back().index_count = 0;
            };
            for (int64_t c = part.first_cluster; c < part.end_cluster; c++) {
                const BandCluster& cluster = scene.clusters[static_cast<size_t>(c)];
                if (cluster.low > last_row || cluster.high < first_row) continue;
                if (!straight) begin_cluster(*cluster.cluster);
                for (int64_t k = cluster.first; k < cluster.end; k++) {
                    const BandTriangle& t = scene.triangles[static_cast<size_t>(k)];
                    if (t.low > last_row || t.high < first_row) continue;
                    if (row.clusters.size() == begun ||
                        row.clusters.back().index_count == MOST_INDICES) {
                        begin_cluster(anywhere);
                    }
                    for (int j = 0; j < 3; j++) {
                        corners[listed_indices + j] = t.corner[j];
                        vertices[listed_indices + j] = t.vertex[j];
                    }
                    listed_indices += 3;
                    row.clusters.back().index_count += 3;
                }
            }
            if (row.clusters.size() == begun) continue;
            listed.push_back(part.part);
            Part& last = listed.back();
            last.cluster_count = static_cast<int32_t>(row.clusters.size() - begun);
            last.corner_x = scene.x.data() + part.corner_at;
            last.corner_y = scene.y.data() + part.corner_at;
            last.corner_z = scene.z.data() + part.corner_at;
        }
    }
    // Where the lists lie is known now.
    const Cluster* clusters = row.clusters.data();
    for (std::vector<Part>* list : {&row.opaque, &row.glass}) {
        for (Part& part : *list) {
            part.clusters = clusters;
            part.corner_indices = row.corners.data();
            part.vertex_indices = row.vertices.data();
            clusters += part.cluster_count;
        }
    }
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
    RowScene listed;
    for (int64_t row = first; row < end; row++) {
        stand_at(row);
        for (size_t k = 0; k < scene.moving_of.size(); k++) {
            if (scene.moving_of[k] == STILL) continue;
            std::copy_n(in.world_from_moving + 16 * (row * in.moving_count + scene.moving_of[k]),
                        16, scene.poses.data() + 16 * k);
        }
        const int32_t top = static_cast<int32_t>(row) * lines;
        list_rows(scene, view.table == nullptr, top, top + lines - 1, listed);
        const DrawList parts{listed.opaque.data(), static_cast<int64_t>(listed.opaque.size())};
        const DrawList glass{listed.glass.data(), static_cast<int64_t>(listed.glass.size())};
        draw_rows(1, scratch, view, seen, parts, glass, in.light, *in.outputs,
                  {top, top + lines, lines});
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
