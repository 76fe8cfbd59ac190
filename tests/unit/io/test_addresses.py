"""Opening from a URL, against a server in this process."""

import threading
import time
from collections import Counter
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
import pytest

import volviz
from tests.unit.io import stores
from volviz.errors import Cancelled, LoadError
from volviz.io import download
from volviz.io.addresses import name_in


class Handler(BaseHTTPRequestHandler):
    """Files of a folder; names say how the server misbehaves."""

    def do_GET(self):
        server = self.server
        server.asked[self.path] += 1
        path = server.folder / self.path.lstrip("/")
        if self.path.startswith("/page"):
            return self.answer(200, b"<html></html>", {"Content-Type": "text/html"})
        if self.path.startswith("/login"):
            return self.answer(403, b"")
        if not path.is_file():
            return self.answer(404, b"")
        content, tag = path.read_bytes(), f'"{path.stat().st_mtime_ns}"'
        if self.headers.get("If-None-Match") == tag:
            return self.answer(304, b"")
        first = 0
        if (wanted := self.headers.get("Range")) and self.headers.get("If-Range", tag) == tag:
            # tensorstore asks for parts as well
            first, last = wanted.removeprefix("bytes=").split("-")
            first, content = int(first), content[int(first) : int(last) + 1 if last else None]
            server.ranges.append(first)
            span = {"Content-Range": f"bytes {first}-{first + len(content) - 1}/{path.stat().st_size}"}
            return self.answer(206, content, {"ETag": tag, **span})
        if self.path.startswith("/slow"):
            return self.answer(200, content, {"ETag": tag}, slow=True)
        cut = len(content) // 2 if self.path.startswith("/broken") and server.asked[self.path] == 1 else None
        return self.answer(200, content, {"ETag": tag}, cut=cut)

    def answer(self, status, content, headers=None, *, cut=None, slow=False):
        self.send_response(status)
        for name, value in (headers or {}).items():
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content[:100] if slow else content[:cut])
        if slow:
            self.wfile.flush()
            self.server.released.wait(5)

    def log_message(self, *args):
        pass


@pytest.fixture
def server(tmp_path, monkeypatch):
    monkeypatch.setenv("no_proxy", "127.0.0.1")
    monkeypatch.setattr(download, "cache_folder", lambda: tmp_path / "cache")
    monkeypatch.setattr(download, "_PAUSE", 0.0)
    found = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    # their ends are waited for
    found.daemon_threads = False
    found.folder = tmp_path / "served"
    found.folder.mkdir()
    found.asked, found.ranges, found.released = Counter(), [], threading.Event()
    found.url = f"http://127.0.0.1:{found.server_port}"
    worker = threading.Thread(target=found.serve_forever)
    worker.start()
    yield found
    found.released.set()
    found.shutdown()
    worker.join()
    found.server_close()


VALUES = stores.small((4, 5, 6))


def served(server, name: str) -> str:
    with (server.folder / name).open("wb") as stream:
        np.save(stream, VALUES)
    return f"{server.url}/{name}"


def test_a_file_is_downloaded_once_and_again_when_it_has_changed(server, monkeypatch):
    url = served(server, "v.npy")
    told: list[str] = []
    volume = volviz.load(url, progress=lambda _fraction, words: told.append(words))
    np.testing.assert_array_equal(volume.array, VALUES)
    assert volume.name == "v"
    assert volume.metadata["source"] == url
    sent = dict(server.asked)
    np.testing.assert_array_equal(volviz.load(url).array, VALUES)
    assert server.asked[f"/{'v.npy'}"] == sent["/v.npy"] + 1
    np.save(server.folder / "v.npy", VALUES + 1)
    np.testing.assert_array_equal(volviz.load(url).array, VALUES + 1)
    monkeypatch.setattr(download, "urlopen", unreachable)
    assert "copy that was downloaded before" in " ".join(volviz.load(url).metadata["notes"])


def unreachable(*args, **kwargs):
    raise download.URLError(ConnectionRefusedError())


def test_a_download_that_breaks_off_goes_on_where_it_stopped(server):
    url = served(server, "broken.npy")
    np.testing.assert_array_equal(volviz.load(url).array, VALUES)
    assert server.ranges == [(server.folder / "broken.npy").stat().st_size // 2]


def test_a_download_is_cancelled_at_once_and_goes_on_later(server):
    url = served(server, "slow.npy")
    begun = time.monotonic()
    with pytest.raises(Cancelled):
        volviz.load(url, cancel=lambda: time.monotonic() > begun + 0.15)
    assert time.monotonic() - begun < 0.35


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("missing.npy", r"^missing.npy: there is nothing at this address \(404\)"),
        ("missing", r"^missing: there is nothing at this address \(404\)"),
        ("page.npy", "leads to a web page"),
        ("login.npy", "the server does not give it to everybody"),
        ("text.bin2", "no reader knows this file"),
        ("missing.zarr", "no Zarr, N5 or precomputed metadata at this address"),
    ],
)
def test_what_cannot_be_had_is_told_in_one_true_sentence(server, path, words):
    (server.folder / "text.bin2").write_bytes(b"hello there")
    with pytest.raises(LoadError, match=words) as caught:
        volviz.open(f"{server.url}/{path}")
    assert "\n" not in str(caught.value)


def test_no_server_and_too_large_a_file_are_told(server, monkeypatch):
    with pytest.raises(LoadError, match=r"^v.npy: the server 127.0.0.1:9 does not answer"):
        volviz.open("http://127.0.0.1:9/v.npy")
    monkeypatch.setattr(download, "LARGEST", 100)
    with pytest.raises(LoadError, match="larger than the 100 bytes that are downloaded"):
        volviz.open(served(server, "v.npy"))


@pytest.mark.parametrize("version", [2, 3])
def test_a_store_is_read_where_it_is_chunk_by_chunk(server, version):
    path = stores.image(server.folder / "v.zarr", [VALUES], [(2, 1, 1)], version=version, chunks=(2, 5, 3))
    missing = next(p for p in path.rglob("*") if p.is_file() and p.name == "1" and p.parent.name == "0")
    missing.unlink()
    source = volviz.open(f"{server.url}/v.zarr")
    assert source.levels[0].spacing == (1, 1, 2)
    assert source.metadata["source"] == f"{server.url}/v.zarr"
    expected = VALUES.copy()
    expected[0:2, :, 3:6] = 0
    before = set(server.asked)
    np.testing.assert_array_equal(source.read(box=(0, 3, 0, 5, 2, 4)).array, expected[2:4, :, 0:3])
    chunks = [path for path in server.asked.keys() - before if path.split("/")[-1].isdigit()]
    assert len(chunks) == 1
    np.testing.assert_array_equal(source.read().array, expected)


def test_a_store_without_an_ending_is_found_and_a_file_url_is_a_path(server, tmp_path):
    stores.array(server.folder / "plain", VALUES)
    np.testing.assert_array_equal(volviz.load(f"{server.url}/plain").array, VALUES)
    served(server, "v.npy")
    np.testing.assert_array_equal(volviz.load((server.folder / "v.npy").as_uri()).array, VALUES)


def test_names_in_addresses():
    assert name_in("https://host/a/b%20c.nii.gz?x=1#y") == "b c.nii.gz"
    assert name_in("https://host/a/..%2Fb.npy") == ".._b.npy"
    assert name_in("s3://bucket") == "bucket"
    assert Path(name_in("https://host/a%2f")).name == "a_"
