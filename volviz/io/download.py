"""Files from the network in the user's cache: progress, cancel, going on where a download broke off."""

from __future__ import annotations

import contextlib
import hashlib
import json
import shutil
import ssl
import threading
import time
from http.client import HTTPException
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any
from urllib.error import HTTPError, URLError
from urllib.request import Request, urlopen

from volviz import __version__
from volviz.errors import LoadError, VolvizError

if TYPE_CHECKING:
    from volviz.io.reader import LoadRequest

#: Bytes of the largest file that is downloaded, of all that are kept, and of the disk that stay free.
LARGEST, KEPT, LEFT_FREE = 8 << 30, 16 << 30, 1 << 30

_BLOCK = 256 << 10

#: Seconds that a server may be silent, and between attempts to go on.
_SILENCE, _PAUSE = 20.0, 0.5

_ATTEMPTS = 4

#: Seconds between two questions whether the user has cancelled.
_PATIENCE = 0.05


def cache_folder() -> Path:
    """Where downloads are kept."""
    from platformdirs import user_cache_path

    return user_cache_path("volviz", appauthor=False) / "downloads"


def downloaded(request: LoadRequest) -> Path:
    """The file at the address of a request, as it is in the cache; it is asked for again when it has changed.

    Raises
    ------
    LoadError
        There is no such file, no network, no room; the file is too large, or a web page.
    Cancelled
        What has come so far is kept, and the next download goes on there.
    """
    download = _Download(request)
    # a thread of its own, since nothing interrupts a call that waits for a server
    worker = threading.Thread(target=download.run, name="volviz-shared-download", daemon=True)
    worker.start()
    try:
        while not download.ended.wait(_PATIENCE):
            request.report(*download.progress)
    finally:
        download.stopped.set()
    if download.error is not None:
        if isinstance(download.error, VolvizError | MemoryError):
            raise download.error
        raise download.failure(download.error) from None
    if download.words:
        request.note(download.words)
    return download.target


class _Download:
    """One download; `run` is called on a thread of its own.

    Attributes
    ----------
    ended, stopped : threading.Event
        It has come to an end; nobody wants it any more.
    error : BaseException or None
    words : str
        For the user, of a download that went well.
    """

    def __init__(self, request: LoadRequest) -> None:
        self._request = request
        digest = hashlib.sha256(request.address.encode()).hexdigest()[:16]
        name = "".join(c if c.isprintable() and c not in '<>:"|?*' else "_" for c in request.path.name)
        self._folder = cache_folder() / digest
        self.target = self._folder / name[-120:]
        self._part = self._folder / "part"
        self._about = self._folder / "about.json"
        self._done, self._total = 0, 0
        self.ended, self.stopped = threading.Event(), threading.Event()
        self.error: BaseException | None = None
        self.words = ""

    @property
    def progress(self) -> tuple[float, str]:
        """Fraction and words."""
        of = f" of {_size(self._total)}" if self._total else ""
        return (self._done / self._total if self._total else 0.0), f"downloading {_size(self._done)}{of}"

    def run(self) -> None:
        """Download, and keep what went wrong."""
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            for attempt in range(_ATTEMPTS):
                before = self._done
                try:
                    self._fetch()
                    break
                except HTTPError:
                    raise
                except (URLError, OSError, HTTPException, EOFError) as error:
                    # a broken connection is worth another attempt; one that never was is none
                    if self.stopped.is_set() or self._done == before or attempt == _ATTEMPTS - 1:
                        raise
                    del error
                    time.sleep(_PAUSE)
        except BaseException as error:  # noqa: BLE001 - raised again by whoever waits
            if self.target.is_file() and isinstance(error, URLError) and not isinstance(error, HTTPError):
                self.words = "The server does not answer; the copy that was downloaded before is shown."
            else:
                self.error = error
        self.ended.set()

    def failure(self, error: BaseException) -> LoadError:
        """One sentence for what went wrong."""
        server = self._request.address.partition("://")[2].partition("/")[0].rpartition("@")[2]
        reason = error.reason if isinstance(error, URLError) and not isinstance(error, HTTPError) else error
        if isinstance(error, HTTPError):
            told = {
                401: "the server asks for a login; download the file with a browser and open it.",
                403: "the server does not give it to everybody; download it with a browser and open it.",
                404: "there is nothing at this address (404); check it.",
                410: "it is no longer at this address (410); look for its new one.",
            }.get(error.code, f"the server {server} answers with an error ({error.code}); try again later.")
        elif isinstance(reason, ssl.SSLError):
            told = f"the connection to {server} is not secure ({reason.reason or 'certificate'}); check the address."
        elif self._done and isinstance(reason, OSError | HTTPException | EOFError) and self._total:
            told = (
                f"the connection broke off after {_size(self._done)} of {_size(self._total)}; "
                "open it again to go on from there."
            )
        elif isinstance(reason, TimeoutError | OSError | HTTPException):
            told = f"the server {server} does not answer; check the address and the network."
        else:
            told = "this is no address that can be read; check it."
        return self._request.error(told)

    def _fetch(self) -> None:
        about = self._known()
        headers = {"User-Agent": f"VolViz/{__version__}", "Accept-Encoding": "identity"}
        have = self._part.stat().st_size if self._part.is_file() and about.get("state") == "part" else 0
        validator = about.get("etag") or about.get("modified")
        if have and validator:
            headers |= {"Range": f"bytes={have}-", "If-Range": str(validator)}
        elif about.get("state") == "complete" and self.target.is_file():
            headers |= {"If-None-Match": about["etag"]} if about.get("etag") else {}
            headers |= {"If-Modified-Since": about["modified"]} if about.get("modified") else {}
        try:
            answer = urlopen(Request(self._request.address, headers=headers), timeout=_SILENCE)  # noqa: S310
        except HTTPError as error:
            error.close()
            if error.code == 304:
                return
            if error.code == 416 and have:
                # there is less than was here before: begin anew
                self._part.unlink()
                self._about.unlink(missing_ok=True)
                self._fetch()
                return
            raise
        with answer:
            self._receive(answer, have if answer.status == 206 else 0)

    def _receive(self, answer: Any, have: int) -> None:
        kind = answer.headers.get_content_type()
        if kind in ("text/html", "application/xhtml+xml"):
            raise self._request.error(
                "the address leads to a web page, not to a file with a volume; copy the link of the download itself."
            )
        length = answer.headers.get("Content-Length", "")
        self._done, self._total = have, have + int(length) if length.isdigit() else 0
        self._check_size(self._total - have)
        about = {"etag": answer.headers.get("ETag"), "modified": answer.headers.get("Last-Modified")}
        # weak validators do not tell whether the bytes are the same
        about["etag"] = None if str(about["etag"]).startswith("W/") else about["etag"]
        self._tell({**about, "state": "part"})
        with self._part.open("ab" if have else "wb") as stream:
            self._copy(answer, stream)
        if self._total and self._done < self._total:
            raise EOFError
        self._part.replace(self.target)
        self._tell({**about, "state": "complete"})

    def _copy(self, answer: Any, stream: IO[bytes]) -> None:
        while not self.stopped.is_set():
            block = answer.read1(_BLOCK)
            if not block:
                return
            stream.write(block)
            self._done += len(block)
            if not self._total and self._done % (64 << 20) < _BLOCK:
                self._check_size(0)
        raise EOFError

    def _check_size(self, more: int) -> None:
        if max(self._total, self._done) > LARGEST:
            raise self._request.error(
                f"it is larger than the {_size(LARGEST)} that are downloaded by themselves; "
                "download it with a browser and open the file."
            )
        _make_room(self._folder, more)
        free = shutil.disk_usage(self._folder).free
        if more + LEFT_FREE > free:
            raise self._request.error(
                f"the download needs {_size(more)}, and {_size(free)} of the disk with {self._folder.parent} are free."
            )

    def _known(self) -> dict[str, Any]:
        try:
            found = json.loads(self._about.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return found if isinstance(found, dict) else {}

    def _tell(self, about: dict[str, Any]) -> None:
        self._about.write_text(json.dumps({"address": self._request.address, **about}), encoding="utf-8")


def _make_room(keep: Path, more: int) -> None:
    """Let go of the downloads that were used least recently, until there is room for more."""
    sizes: dict[Path, int] = {}
    for folder in keep.parent.iterdir():
        with contextlib.suppress(OSError):
            sizes[folder] = sum(file.stat().st_size for file in folder.iterdir())
    for folder in sorted(sizes, key=lambda folder: folder.stat().st_mtime if folder.exists() else 0.0):
        if sum(sizes.values()) + more <= KEPT:
            return
        if folder != keep:
            shutil.rmtree(folder, ignore_errors=True)
            del sizes[folder]


def _size(count: int) -> str:
    """Bytes in words: "340 MB"."""
    for unit, size in (("GB", 1 << 30), ("MB", 1 << 20), ("kB", 1 << 10)):
        if count >= size:
            return f"{count / size:.3g} {unit}"
    return f"{count} bytes"
