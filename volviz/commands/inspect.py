"""Commands that look things up: ``info``, ``samples``, ``techniques``, ``presets``, ``looks``, ``doctor``."""

from __future__ import annotations

import argparse
import json
from typing import Any

from volviz.commands.inputs import add_input, hints_of, load_input, source_of


def add_commands(commands: Any) -> None:
    """Add the commands of this file."""
    info = commands.add_parser(
        "info", help="what a file holds", description="Reads the headers of a file and says what it holds."
    )
    add_input(info)
    info.add_argument("--json", action="store_true", help="as JSON")
    info.add_argument(
        "--statistics",
        action="store_true",
        help="read the values as well, and say between which limits they lie",
    )
    info.set_defaults(run=run_info)

    samples = commands.add_parser("samples", help="list the bundled volumes")
    samples.add_argument("--json", action="store_true", help="as JSON")
    samples.set_defaults(run=run_samples)

    techniques = commands.add_parser("techniques", help="list the rendering techniques and their settings")
    techniques.add_argument("id", nargs="?", help="one technique, with its settings")
    techniques.add_argument("--json", action="store_true", help="as JSON")
    techniques.set_defaults(run=run_techniques)

    presets = commands.add_parser("presets", help="list the transfer-function presets")
    presets.add_argument("--json", action="store_true", help="as JSON")
    presets.set_defaults(run=run_presets)

    looks = commands.add_parser(
        "looks",
        help="list the ways of showing a file that suit it",
        description="Reads a file and lists the looks that suit its values, the best one first.",
    )
    add_input(looks)
    looks.set_defaults(run=run_looks)

    doctor = commands.add_parser("doctor", help="what this machine has, what is missing and how to get it")
    doctor.set_defaults(run=run_doctor)


def run_info(options: argparse.Namespace) -> int:
    """Print what a file holds."""
    from volviz.io import info

    found = info(source_of(options), statistics=options.statistics, **hints_of(options))
    if options.json:
        _say(json.dumps(found, indent=2))
        return 0
    unit = f" {found['unit']}" if found["unit"] else ""
    length = f" {found['length_unit']}" if found["length_unit"] else ""
    kind = f", {found['dtype']}" if found["dtype"] else ""
    rows = [
        ("name", found["name"]),
        ("format", found["format"]),
        ("voxels", " x ".join(str(n) for n in found["dims"]) + " (x, y, z)" + kind),
        ("spacing", " x ".join(f"{s:g}" for s in found["spacing"]) + length),
        ("origin", ", ".join(f"{v:g}" for v in found["origin"]) + f"{length} (LPS)"),
        ("direction", "; ".join(
            ", ".join(f"{v:g}" for v in found["direction"][3 * row : 3 * row + 3]) for row in range(3)
        )),
    ]  # fmt: skip
    if found["bytes"] is not None:
        rows.insert(3, ("memory", f"{found['bytes'] / 2**20:.1f} MB"))
    if found["range"] is not None:
        rows.append(("range", f"{found['range'][0]:g} to {found['range'][1]:g}{unit}"))
    if "t" in found["sizes"]:
        times = found["times"]
        when = "" if times is None else f", from {times[0]:g} to {times[-1]:g} s"
        rows.append(("time points", f"{found['sizes']['t']}{when}"))
    if "c" in found["sizes"]:
        names = ", ".join(name for name in found["channels"] if name)
        rows.append(("channels", f"{found['sizes']['c']}{f' ({names})' if names else ''}"))
    if len(found["levels"]) > 1:
        rows += [
            (f"level {number}", " x ".join(str(n) for n in level["dims"]) + ", spacing "
             + " x ".join(f"{s:g}" for s in level["spacing"]) + length)
            for number, level in enumerate(found["levels"])
        ]  # fmt: skip
    if found["labels"]:
        named = ", ".join(f"{number} {name}".strip() for number, name in found["labels"][:12])
        rows.append(
            ("labels", f"{len(found['labels'])}: {named}{', …' if len(found['labels']) > 12 else ''}")
        )
    if len(found["series"]) > 1:
        rows += [("holds", words) for words in found["series"]]
    if found["nonfinite"]:
        rows.append(("not finite", f"{found['nonfinite']} values, drawn as the lowest one"))
    rows += [("note", note) for note in found["notes"]]
    for label, text in rows:
        _say(f"{label + ':':<12} {text}")
    return 0


def run_samples(options: argparse.Namespace) -> int:
    """List the bundled volumes."""
    from volviz.io.samples import samples

    if options.json:
        _say(json.dumps([_plain(sample) for sample in samples()], indent=2))
        return 0
    width = max(len(sample.id) for sample in samples())
    for sample in samples():
        _say(f"sample:{sample.id:<{width}}  {sample.label}: {sample.description} [{sample.licence}]")
    return 0


def run_techniques(options: argparse.Namespace) -> int:
    """List the techniques, or the settings of one."""
    from volviz.custom_gl.registry import technique, techniques

    chosen = [technique(options.id)] if options.id else list(techniques().values())
    if options.json:
        _say(json.dumps([_technique(info) for info in chosen], indent=2))
        return 0
    if not options.id:
        width = max(len(info.id) for info in chosen)
        for info in chosen:
            _say(f"{info.id:<{width}}  {info.summary}")
        _say("\nvolviz techniques ID lists the settings of one.")
        return 0
    (info,) = chosen
    _say(f"{info.id}: {info.label}. {info.summary}\n")
    for p in info.parameters:
        default = p.none_label if p.default is None else p.default
        choices = f" ({', '.join(key for key, _ in p.choices)})" if p.choices else ""
        _say(f"  {p.name} = {default}{' ' + p.unit if p.unit else ''}{choices}\n      {p.tooltip}")
    return 0


def run_presets(options: argparse.Namespace) -> int:
    """List the presets."""
    from volviz.model.transfer.presets import presets

    if options.json:
        _say(json.dumps({p.id: {"label": p.label, "description": p.description, "modality": p.modality,
                                "transfer_function": p.transfer_function.to_dict()}
                         for p in presets().values()}, indent=2))  # fmt: skip
        return 0
    width = max(len(ident) for ident in presets())
    for preset in presets().values():
        _say(f"{preset.id:<{width}}  {preset.label}: {preset.description}")
    return 0


def run_looks(options: argparse.Namespace) -> int:
    """List the looks of a file."""
    from volviz.model.looks.choice import looks

    found = looks(load_input(options))
    width = max(len(ident) for ident in found)
    for look in found.values():
        _say(f"{look.id:<{width}}  {look.label}: {look.description} [{look.technique}]")
    return 0


def run_doctor(_options: argparse.Namespace) -> int:
    """Run all checks; the status is 1 when something essential is missing."""
    from volviz.doctor import report, run_checks, worst

    checks = list(run_checks())
    _say(report(checks))
    return 1 if worst(checks) == "fail" else 0


def _technique(info: Any) -> dict[str, Any]:
    return {
        "id": info.id,
        "label": info.label,
        "summary": info.summary,
        "kind": info.kind,
        "settings": [
            {
                "name": p.name, "kind": p.kind, "default": p.default, "unit": p.unit, "tooltip": p.tooltip,
                "minimum": p.minimum, "maximum": p.maximum, "choices": [key for key, _ in p.choices],
                "cost": p.cost.name,
            }
            for p in info.parameters
        ],
    }  # fmt: skip


def _plain(sample: Any) -> dict[str, Any]:
    return {
        name: getattr(sample, name)
        for name in ("id", "label", "description", "licence", "source", "modality")
    }


def _say(text: str) -> None:
    print(text)
