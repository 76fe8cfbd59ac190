"""The doctor on the machine that runs the tests, which must be healthy."""

from __future__ import annotations

import volviz.doctor
from volviz.doctor import graphics
from volviz.doctor.child import run_python


def test_the_doctor_finds_a_machine_that_can_run_the_tests_healthy() -> None:
    checks = list(volviz.doctor.run_checks())
    assert [check for check in checks if check.status == "fail"] == []
    assert {"system", "Python", "packages", "kernels", "disk cache", "OpenGL"} <= {c.name for c in checks}


def test_the_probe_tells_version_and_limits() -> None:
    result = run_python("import sys; from volviz.doctor.gl_probe import main; main('offscreen')")
    answer = graphics.parse_answer(result)
    assert answer is not None, result.errors
    assert answer["code"] >= graphics.NEEDED_VERSION
    assert answer["texture_3d"] >= 256
    assert answer["renderer"]
