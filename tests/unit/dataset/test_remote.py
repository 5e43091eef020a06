"""Data sets at remote places and by clusters: a server of S3's protocol, a real Ray cluster."""

from __future__ import annotations

import json
import uuid
from collections.abc import Iterator
from pathlib import Path

import boto3
import pytest
import ray
from moto.server import ThreadedMotoServer
from ray.cluster_utils import Cluster

from sailenv_ros.dataset import engine_of, load_job, make_dataset
from sailenv_ros.dataset.manifest import done_shards
from sailenv_ros.dataset.remote_storage import open_storage
from sailenv_ros.errors import RecordingError
from tests.unit.dataset.conftest import written_recipe
from tests.unit.dataset.test_making import contents


@pytest.fixture
def bucket(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The URL of an empty bucket on a server of this process."""
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://{host}:{port}")
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "test")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "test")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    name = f"bucket-{uuid.uuid4().hex[:8]}"
    boto3.client("s3").create_bucket(Bucket=name)
    yield f"s3://{name}/sets/small"
    server.stop()


@pytest.mark.timeout(300)
def test_the_same_files_are_at_a_remote_place(small: Path, bucket: str) -> None:
    """Every byte but those that tell of the machine; a lost shard is made again."""
    job = load_job(small.parent / "small.yaml")
    made = make_dataset(job, bucket, engine_of(1, None))
    known = json.loads((small / "manifest.json").read_text())
    assert made.sha256 == known["sha256"]
    store = open_storage(bucket)
    assert store.read("README.md") == (small / "README.md").read_bytes()
    name = "webdataset/train-00001.tar"
    assert store.read(name) == (small / name).read_bytes()
    files = store._files  # type: ignore[attr-defined]
    root = bucket.removeprefix("s3://")
    files.rm([f"{root}/manifest.json", f"{root}/shards/00002.json"])
    assert sorted(done_shards(store)) == [0, 1, 3]
    assert make_dataset(job, bucket, engine_of(1, None)).sha256 == known["sha256"]
    assert sorted(done_shards(store)) == [0, 1, 2, 3]


def test_unknown_places_are_refused() -> None:
    """A kind of URL that there is not."""
    with pytest.raises(RecordingError, match="nowhere://x/y cannot be reached"):
        open_storage("nowhere://x/y")


@pytest.mark.timeout(600)
def test_a_cluster_that_loses_a_node_makes_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two nodes, one of which is killed in the middle: its shards are made by the other."""
    monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
    recipe = written_recipe(tmp_path, shard={"clips": 1})
    job = load_job(recipe)
    cluster = Cluster(
        initialize_head=True,
        head_node_args={"num_cpus": 1, "include_dashboard": False, "object_store_memory": 10**8},
    )
    try:
        second = cluster.add_node(num_cpus=1, object_store_memory=10**8)
        cluster.wait_for_nodes()
        killed = []

        def kill_one(progress: object) -> None:
            if getattr(progress, "shards", 0) >= 2 and not killed:
                killed.append(True)
                cluster.remove_node(second, allow_graceful=False)

        folder = tmp_path / "made"
        engine = engine_of(1, cluster.address)
        made = make_dataset(job, folder, engine, on_progress=kill_one)
        assert killed
        assert (made.shards, made.frames) == (7, 42)
    finally:
        ray.shutdown()
        cluster.shutdown()
    make_dataset(job, tmp_path / "here", engine_of(1, None))
    assert contents(folder) == contents(tmp_path / "here")


def test_a_cluster_that_is_not_there_is_told(tmp_path: Path) -> None:
    """In one sentence with its address; the folder can be gone on with."""
    job = load_job(written_recipe(tmp_path))
    with pytest.raises(RecordingError, match=r"no Ray cluster at '127\.0\.0\.1:9'"):
        make_dataset(job, tmp_path / "made", engine_of(1, "127.0.0.1:9"))
