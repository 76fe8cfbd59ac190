"""One finding of the doctor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Status = Literal["ok", "warn", "fail"]
MARKS: dict[Status, str] = {"ok": "+", "warn": "!", "fail": "x"}


@dataclass(frozen=True)
class Check:
    """One thing that was looked at.

    Parameters
    ----------
    name : str
        What was looked at, in one to three words.
    status : {"ok", "warn", "fail"}
        Fine; works, but could be better; does not work.
    detail : str
        What was found.
    remedy : str
        What to do about it; empty when there is nothing to do.
    """

    name: str
    status: Status
    detail: str
    remedy: str = ""

    def line(self) -> str:
        """The finding as text: a line, and a second one where something is to be done."""
        text = f"{MARKS[self.status]} {self.name:<16} {self.detail}"
        return f"{text}\n  {'':<16} -> {self.remedy}" if self.remedy else text
