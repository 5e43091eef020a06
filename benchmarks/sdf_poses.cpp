// Reads an SDFormat file with the library that Gazebo reads it with: errors, poses, joints' axes.
//
//     g++ benchmarks/sdf_poses.cpp -o sdf_poses $(pkg-config --cflags --libs sdformat12)
#include <iomanip>
#include <iostream>
#include <sdf/sdf.hh>

static void print(const sdf::Model &model, const ignition::math::Pose3d &world_from_model) {
    for (uint64_t number = 0; number < model.LinkCount(); ++number) {
        const sdf::Link *link = model.LinkByIndex(number);
        ignition::math::Pose3d pose;
        if (!link->SemanticPose().Resolve(pose, "__model__").empty()) std::cout << "error pose\n";
        pose = world_from_model * pose;
        std::cout << "link " << link->Name() << " " << pose.Pos() << " " << pose.Rot().X() << " "
                  << pose.Rot().Y() << " " << pose.Rot().Z() << " " << pose.Rot().W() << "\n";
    }
    for (uint64_t number = 0; number < model.JointCount(); ++number) {
        const sdf::JointAxis *axis = model.JointByIndex(number)->Axis();
        ignition::math::Vector3d found;
        if (axis == nullptr) continue;
        if (!axis->ResolveXyz(found, "__model__").empty()) std::cout << "error axis\n";
        std::cout << "joint " << model.JointByIndex(number)->ChildLinkName() << " "
                  << world_from_model.Rot() * found << " " << axis->Lower() << " "
                  << axis->Upper() << "\n";
    }
}

int main(int, char **arguments) {
    sdf::Root root;
    std::cout << std::setprecision(17);
    for (const sdf::Error &error : root.Load(std::string(arguments[1]))) {
        std::cout << "error " << error.Message() << "\n";
    }
    if (root.Model() != nullptr) print(*root.Model(), root.Model()->RawPose());
    for (uint64_t number = 0; number < root.WorldCount(); ++number) {
        const sdf::World *world = root.WorldByIndex(number);
        for (uint64_t place = 0; place < world->ModelCount(); ++place) {
            print(*world->ModelByIndex(place), world->ModelByIndex(place)->RawPose());
        }
    }
}
