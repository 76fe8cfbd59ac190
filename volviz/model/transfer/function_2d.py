"""Two-dimensional transfer functions: colour and opacity over value and gradient magnitude.

Borders between materials have large gradients and lie between the values of both; regions in the plane of
value and gradient magnitude pick them out where a curve over the value alone cannot (Kindlmann and Durkin
1998; Kniss, Kindlmann and Hansen 2002).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError

Kind = Literal["rectangle", "ellipse", "triangle"]
KINDS: tuple[Kind, ...] = ("rectangle", "ellipse", "triangle")
Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Region:
    """A part of the plane of value and gradient magnitude with a colour and an opacity.

    Attributes
    ----------
    kind : {"rectangle", "ellipse", "triangle"}
        A triangle stands on its tip: narrow at `gradient_low`, as wide as `width` at `gradient_high`.
    value : float
        Middle, data units.
    width : float
        Full extent along the values, greater than 0.
    gradient_low, gradient_high : float
        Extent along the gradient magnitudes, data units per world unit, ``0 <= low < high``.
    color : tuple of 3 floats
        Red, green, blue in 0..1.
    opacity : float
        In the middle, 0..1, of a piece of ray one unit distance long.
    softness : float
        Part of the way from the edge to the middle over which the opacity rises, 0 (hard edge) to 1.
    """

    kind: Kind
    value: float
    width: float
    gradient_low: float
    gradient_high: float
    color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    opacity: float = 0.3
    softness: float = 0.5

    def __post_init__(self) -> None:
        numbers = (self.value, self.width, self.gradient_low, self.gradient_high)
        if self.kind not in KINDS:
            raise InputError(f"a region is one of {', '.join(KINDS)}, not {self.kind!r}.")
        if (
            not all(np.isfinite(numbers))
            or self.width <= 0
            or not 0 <= self.gradient_low < self.gradient_high
        ):
            raise InputError(
                "a region needs a width above 0 and gradients 0 <= low < high, "
                f"got width {self.width!r}, gradients {self.gradient_low!r} to {self.gradient_high!r}."
            )
        if not all(0.0 <= c <= 1.0 for c in (*self.color, self.opacity, self.softness)):
            raise InputError(
                "colour, opacity and softness of a region lie between 0 and 1, "
                f"got {self.color}, {self.opacity!r}, {self.softness!r}."
            )

    def weight(self, values: npt.ArrayLike, gradients: npt.ArrayLike) -> Floats:
        """How much a place belongs to the region: 1 inside, 0 outside, in between within the soft edge.

        Parameters
        ----------
        values, gradients : array_like, shapes that broadcast
            Data units; data units per world unit.
        """
        x = np.abs(np.asarray(values, np.float64) - self.value) / (self.width / 2)
        height = self.gradient_high - self.gradient_low
        up = (np.asarray(gradients, np.float64) - self.gradient_low) / height
        if self.kind == "ellipse":
            distance = np.hypot(x, 2.0 * up - 1.0)
        elif self.kind == "rectangle":
            distance = np.maximum(x, np.abs(2.0 * up - 1.0))
        else:
            # the half width grows from 0 at the tip to 1 at the top
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                across = np.where(up > 0.0, x / up, np.inf)
            distance = np.where(up > 1.0, np.inf, across)
        if self.softness == 0.0:
            return np.asarray(distance <= 1.0, dtype=np.float64)
        return np.asarray(np.clip((1.0 - distance) / self.softness, 0.0, 1.0))

    def moved(self, value: float, gradient: float) -> Region:
        """The region elsewhere; it stops at gradient 0."""
        gradient = max(gradient, -self.gradient_low)
        return replace(
            self,
            value=self.value + value,
            gradient_low=self.gradient_low + gradient,
            gradient_high=self.gradient_high + gradient,
        )


@dataclass(frozen=True)
class TransferFunction2D:
    """Regions that together give colour and opacity by value and gradient magnitude.

    Where regions overlap their extinctions add up, as if both materials were there: opacities combine to
    ``1 - (1 - a)(1 - b)`` and the colours are mixed by opacity.

    Attributes
    ----------
    regions : tuple of Region
        In any number; without any, nothing is visible.
    enabled : bool
        Whether it is used instead of the curve over the value alone.
    """

    regions: tuple[Region, ...] = ()
    enabled: bool = True

    def evaluate(self, values: npt.ArrayLike, gradients: npt.ArrayLike) -> Floats:
        """Straight RGBA.

        Parameters
        ----------
        values, gradients : array_like, shapes that broadcast
            Data units; data units per world unit.

        Returns
        -------
        ndarray of the broadcast shape + (4,)
            Red, green, blue, opacity in 0..1; colour 0 where nothing is.
        """
        shape = np.broadcast_shapes(np.shape(values), np.shape(gradients))
        color = np.zeros((*shape, 3))
        total = np.zeros(shape)
        through = np.ones(shape)
        for region in self.regions:
            alpha = region.opacity * region.weight(values, gradients)
            color += alpha[..., None] * np.asarray(region.color)
            total += alpha
            through *= 1.0 - alpha
        safe = np.where(total > 0, total, 1.0)[..., None]
        return np.concatenate([color / safe, (1.0 - through)[..., None]], axis=-1)

    def bake(
        self,
        value_range: tuple[float, float],
        gradient_range: tuple[float, float],
        size: tuple[int, int] = (512, 256),
    ) -> npt.NDArray[np.float32]:
        """The function on a lattice of values and gradients, ends included.

        Returns
        -------
        ndarray of shape (gradients, values, 4), float32
            Straight RGBA; row 0 holds the smallest gradient. Entries lie where those of
            `TransferFunction.bake` lie, along both axes.
        """
        values = np.linspace(*value_range, size[0])
        gradients = np.linspace(*gradient_range, size[1])
        return self.evaluate(values[None, :], gradients[:, None]).astype(np.float32)

    # ------------------------------------------------------------------ edits

    def with_region(self, region: Region) -> TransferFunction2D:
        """With one more region, the last."""
        return replace(self, regions=(*self.regions, region))

    def with_changed_region(self, index: int, **changes: Any) -> TransferFunction2D:
        """With some attributes of one region changed."""
        regions = list(self.regions)
        regions[index] = replace(regions[index], **changes)
        return replace(self, regions=tuple(regions))

    def without_regions(self, indices: Iterable[int]) -> TransferFunction2D:
        """Without the regions of these indices."""
        drop = set(indices)
        return replace(self, regions=tuple(r for i, r in enumerate(self.regions) if i not in drop))

    def mapped(self, factor: float, center: float, offset: float) -> TransferFunction2D:
        """Values stretched about a center and then moved, as the curve is; gradients stay."""
        return replace(
            self,
            regions=tuple(
                replace(r, value=center + (r.value - center) * factor + offset, width=r.width * factor)
                for r in self.regions
            ),
        )

    # ------------------------------------------------------------------ to and from plain data

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        regions = [{**asdict(r), "color": list(r.color)} for r in self.regions]
        return {"enabled": self.enabled, "regions": regions}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> TransferFunction2D:
        """The function that `to_dict` described.

        Raises
        ------
        InputError
            The data does not describe one.
        """
        try:
            regions = tuple(_region(one) for one in data["regions"])
        except (KeyError, TypeError, ValueError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(
                'a two-dimensional transfer function needs "regions": a list of objects with kind, value, '
                "width, gradient_low, gradient_high, color, opacity and softness."
            ) from None
        return cls(regions, bool(data.get("enabled", True)))


def _region(data: Mapping[str, Any]) -> Region:
    red, green, blue = (float(c) for c in data["color"])
    return Region(
        data["kind"],
        float(data["value"]),
        float(data["width"]),
        float(data["gradient_low"]),
        float(data["gradient_high"]),
        (red, green, blue),
        float(data["opacity"]),
        float(data["softness"]),
    )
