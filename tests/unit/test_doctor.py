"""The doctor's findings, from what it is told; nothing here depends on the machine."""

from __future__ import annotations

from pathlib import Path

import pytest
from packaging.requirements import Requirement

from volviz import doctor
from volviz.doctor import graphics, machine
from volviz.doctor.check import Check
from volviz.doctor.child import ChildResult, run_python

LLVMPIPE = {
    "code": 450,
    "renderer": "llvmpipe (LLVM 15.0.6, 256 bits)",
    "texture_3d": 2048,
}


def test_a_process_that_crashes_is_a_finding_and_not_a_crash() -> None:
    result = run_python("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    assert result.status == -11
    assert graphics.parse_answer(result) is None
    assert result.last_error() == "the process was ended by signal 11"


def test_a_process_that_hangs_is_ended() -> None:
    result = run_python("import time; time.sleep(60)", timeout=0.5)
    assert result.status == 124
    assert "no answer within" in result.last_error()


def test_an_exception_is_reported_by_its_last_line() -> None:
    assert run_python("raise RuntimeError('no screen')").last_error() == "RuntimeError: no screen"


def test_the_answer_is_found_below_warnings() -> None:
    result = ChildResult(0, 'Setting a new default format\n{"code": 450}\n', "")
    assert graphics.parse_answer(result) == {"code": 450}
    assert graphics.parse_answer(ChildResult(0, "no json at all", "")) is None


@pytest.mark.parametrize(
    ("answer", "status"),
    [
        (LLVMPIPE, "warn"),
        (LLVMPIPE | {"renderer": "AMD Radeon"}, "ok"),
        (LLVMPIPE | {"renderer": "AMD Radeon", "texture_3d": 256}, "warn"),
        (LLVMPIPE | {"renderer": "AMD Radeon", "code": 310}, "fail"),
    ],
)
def test_a_context_is_judged_by_version_limits_and_renderer(answer: dict[str, object], status: str) -> None:
    check = graphics.judge("OpenGL", "", answer)
    assert check.status == status
    assert bool(check.remedy) == (status != "ok")


@pytest.mark.parametrize(
    ("errors", "package"),
    [
        (
            "ImportError: libGL.so.1: cannot open shared object file: No such file or directory",
            "libgl1",
        ),
        ("MESA-LOADER: failed to open swrast: /usr/lib/dri/swrast_dri.so", "libgl1-mesa-dri"),
        ("qt.glx: Could not initialize GLX", "libglx-mesa0"),
    ],
)
def test_known_messages_lead_to_one_package(errors: str, package: str) -> None:
    remedy = graphics.remedy_for(ChildResult(1, "", errors))
    assert remedy.split()[-1] == package


def test_a_package_outside_its_tested_versions_is_named() -> None:
    assert machine.package_problem(Requirement("numpy>=1")) is None
    problem = machine.package_problem(Requirement("numpy<1"))
    assert problem is not None
    assert problem.endswith("VolViz is tested with <1.")
    assert machine.package_problem(Requirement("volviz-no-such-thing>=1")) == (
        "volviz-no-such-thing is not installed."
    )


def test_the_cache_of_kernels_follows_numbas_own_override(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "not-made-yet"))
    (check,) = machine.check_disk()
    assert str(tmp_path / "not-made-yet") in check.detail
    assert check.status == "ok"


def test_a_cache_that_cannot_be_written_is_a_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/proc/volviz")
    (check,) = machine.check_disk()
    assert check.status == "warn"
    assert check.remedy


def test_the_gravest_finding_decides() -> None:
    fine, better, broken = Check("a", "ok", ""), Check("b", "warn", ""), Check("c", "fail", "")
    assert doctor.worst([]) == "ok"
    assert doctor.worst([fine, better]) == "warn"
    assert doctor.worst([broken, better, fine]) == "fail"


def test_a_report_names_each_finding_and_its_remedy() -> None:
    text = doctor.report([Check("disk", "warn", "3 bytes free", "make room"), Check("GL", "ok", "4.5")])
    assert "! disk" in text
    assert "-> make room" in text
    assert "+ GL" in text
    assert text.endswith("say what could be better.")
