"""Two processes: a simulator, and a program that knows ROS's `simulation_interfaces` alone.

The same program works with Gazebo, Isaac Sim and O3DE, as far as these offer the services.
"""

import subprocess
import sys
from typing import Any

import rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from simulation_interfaces.msg import EntityFilters, Resource, SimulationState
from simulation_interfaces.srv import (
    GetEntities,
    GetEntityState,
    GetSimulatorFeatures,
    LoadWorld,
    ResetSimulation,
    SetSimulationState,
    SpawnEntity,
    StepSimulation,
)

NAMESPACE = "/standard_example"
SIMULATOR = [
    *(sys.executable, "-m", "sailenv_ros.ros.nodes.sim_node", "--ros-args"),
    *("-r", f"__ns:={NAMESPACE}", "-p", "mode:=lockstep", "-p", "publish_clock:=false"),
    *("-p", "scene:=optical", "-p", "viewer.port:=0", "-p", "gateway.port:=0"),
]


class Client(Node):
    """Calls services by their types and names."""

    def __init__(self) -> None:
        super().__init__("client", namespace=NAMESPACE)

    def call(self, kind: Any, name: str, /, **fields: Any) -> Any:
        """Call a service; a refusal ends the program with its sentence."""
        client = self.create_client(kind, name)
        client.wait_for_service()
        future = client.call_async(kind.Request(**fields))
        rclpy.spin_until_future_complete(self, future)
        answer = future.result()
        if hasattr(answer, "result") and answer.result.result != answer.result.RESULT_OK:
            sys.exit(f"{name}: {answer.result.error_message}")
        return answer


def resource(kind: Any, field: str, uri: str) -> dict[str, Any]:
    """Return a resource as either version of the interfaces has it: 1.5 or 2.1."""
    return {"uri": uri} if hasattr(kind.Request, "uri") else {field: Resource(uri=uri)}


def work(client: Client) -> None:
    """Load a world, let a ball fall twice, look whether that was the same, and quit."""
    features = client.call(GetSimulatorFeatures, "get_simulator_features").features
    print(len(features.features), "features;", features.custom_info)
    world = resource(LoadWorld, "world_resource", "sailenv://scene/solid_benchmark")
    print("world:", client.call(LoadWorld, "load_world", **world).world.description)
    paused = SimulationState(state=SimulationState.STATE_PAUSED)
    client.call(SetSimulationState, "set_simulation_state", state=paused)

    heights = []
    for run in range(2):
        place = PoseStamped()
        place.pose.position.x, place.pose.position.z = 1.5, 3.0
        ball = resource(SpawnEntity, "entity_resource", "sailenv://asset/sphere")
        client.call(SpawnEntity, "spawn_entity", name="my_ball", initial_pose=place, **ball)
        client.call(StepSimulation, "step_simulation", steps=120)
        state = client.call(GetEntityState, "get_entity_state", entity="my_ball").state
        heights.append(state.pose.position.z)
        print(f"run {run + 1}: the ball is at z = {state.pose.position.z!r} m")
        client.call(ResetSimulation, "reset_simulation")
    print("equal bytes:", heights[0] == heights[1])
    left = client.call(GetEntities, "get_entities", filters=EntityFilters(filter="^my_ball$"))
    print("left after the reset:", list(left.entities))

    quitting = SimulationState(state=SimulationState.STATE_QUITTING)
    client.call(SetSimulationState, "set_simulation_state", state=quitting)


rclpy.init()
with subprocess.Popen(SIMULATOR) as simulator:
    try:
        work(Client())
        print("the simulator ended with status", simulator.wait())
    finally:
        simulator.terminate()
rclpy.shutdown()
