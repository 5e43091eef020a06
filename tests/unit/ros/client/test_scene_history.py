"""Recent announcements by their revisions: exact, bounded, of one simulator."""

from __future__ import annotations

from sailenv_ros.ros.client.scene_history import DEPTH, SceneHistory
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.scene_info import SceneInfo


def info_of(revision: int) -> SceneInfo:
    """Make an announcement with nothing in it."""
    return SceneInfo(
        scene="optical",
        scenes=(),
        epoch=1,
        revision=revision,
        sim_time_ns=0,
        mode="lockstep",
        paused=False,
        real_time_factor=1.0,
        seed=0,
        categories=CategoryTable([]),
        instances=(),
    )


def test_a_revision_is_its_own_announcement_or_none() -> None:
    """One that was lost is not replaced by the next one."""
    history = SceneHistory()
    assert history.latest is None
    infos = {revision: info_of(revision) for revision in (1, 2, 5)}
    for info in infos.values():
        history.add(info)
    assert history.latest is infos[5]
    assert [history.of_revision(r) for r in (1, 2, 4, 5)] == [infos[1], infos[2], None, infos[5]]


def test_old_announcements_are_let_go() -> None:
    """The newest `DEPTH` are kept, whatever their revisions."""
    history = SceneHistory()
    for revision in range(0, 4 * DEPTH, 2):
        history.add(info_of(revision))
    kept = [r for r in range(4 * DEPTH) if history.of_revision(r) is not None]
    assert kept == list(range(2 * DEPTH, 4 * DEPTH, 2))


def test_another_simulator_counts_anew() -> None:
    """Revisions of the one before do not answer for it."""
    history = SceneHistory()
    for revision in (7, 8, 1):
        history.add(info_of(revision))
    assert history.latest is not None
    assert history.latest.revision == 1
    assert history.of_revision(7) is None
