"""A scenario: a scene with additional objects, as text; the response contains their ids."""

from sailenv_ros import Agent

SCENARIO = """
scene: solid_benchmark
objects:
  - {name: slow, asset: cube, position: [0, 2, 6], gravity: false,
     behaviours: [{type: rotate_rigidbody, angular_velocity: [0, 0, 30]}]}
  - {name: fast, asset: cube, position: [0, -2, 6], gravity: false,
     behaviours: [{type: rotate_rigidbody, angular_velocity: [0, 0, 180]}]}
  - {asset: sphere, position: [2, 0, 8], scale: 0.5}
"""

LOCKSTEP = {"scene": "optical", "mode": "lockstep"}

with Agent(width=320, height=240, namespace="/example", simulator=LOCKSTEP) as agent:
    ids = agent.load_scenario(SCENARIO)
    for _ in range(3):
        for id_ in ids:
            state = agent.get_object(id_)
            print(
                f"{state.sim_time_ns * 1e-9:.2f} s: {state.name:<9} at z = "
                f"{state.pose.position_m[2]:5.2f} m, yaw {state.pose.rpy_deg[2]:7.2f} deg"
            )
        agent.step(60)
    agent.reset()  # the scenario's objects belong to its start
    print("after a reset:", [agent.instances[id_].name for id_ in ids])
