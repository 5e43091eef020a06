"""Objects that are spawned, fall, turn, are moved and removed; their ids are pixel values."""

import numpy as np

from sailenv_ros import Agent, look_at

LOCKSTEP = {"scene": "optical", "mode": "lockstep"}

with Agent(width=320, height=240, following=False, namespace="/example", simulator=LOCKSTEP) as eye:
    eye.set_pose(look_at((-5.0, 0.0, 2.0), (-2.0, 0.0, 1.0)), teleport=True)
    names = eye.spawnable_objects_names
    print(f"{len(names)} assets: {', '.join(names[:6])} …")

    # Static unless told otherwise, as in the SAILenv client.
    shelf = eye.spawn_object("cube", (-2.0, 0.0, 0.8), scale=(0.5, 2.0, 0.1), object_name="shelf")
    ball = eye.spawn_object("sphere", (-2.0, 0.5, 2.0), remove_dynamics=False, scale=0.3)
    turning = {"type": "rotate_rigidbody", "angular_velocity": [0, 0, 90]}
    top = eye.spawn_object("cube", (-2.0, -0.6, 1.06), scale=0.4, behaviours=[turning])

    for _ in range(4):
        frame = eye.get_frame()
        seen = {id_: int((frame["instance"] == id_).sum()) for id_ in (shelf, ball, top)}
        height = eye.get_object(ball).pose.position_m[2]
        pixels_of = {eye.instances[id_].name: pixels for id_, pixels in seen.items()}
        print(
            f"t = {frame['stamp_ns'] * 1e-9:.2f} s: ball is at {height:.2f} m; pixels: {pixels_of}"
        )
        eye.step(48)

    eye.move_object("shelf", (-2.0, 0.0, 1.0))  # motion: the flow shows it
    frame = eye.get_frame()
    flow = frame["flow"][frame["instance"] == shelf]
    print(f"the shelf moves up: {-np.median(flow[:, 1]):.0f} px/s")

    for id_ in (shelf, ball, top):
        eye.despawn_object(id_)
    gone = set(np.unique(eye.get_frame()["instance"]).tolist())
    print("gone:", not gone & {shelf, ball, top})
