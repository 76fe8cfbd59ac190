"""How alike two images are: PSNR, SSIM with its map, differences. Plain arrays, no OpenGL.

Images have shape (H, W), (H, W, 3) or (H, W, 4); unsigned bytes count from 0 to 255, floats from 0 to 1. An alpha
channel is left out: what is compared is what is seen over a background. Differences are given in levels of 0..255
whatever the type.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError

Array = npt.NDArray[Any]
Float64Array = npt.NDArray[np.float64]

#: Levels of a channel of a byte.
LEVELS = 255.0
#: Window of the local statistics of SSIM in pixels: square, or as far as the Gaussian reaches (3.5 sigma).
SQUARE_WINDOW, GAUSSIAN_WINDOW, SIGMA = 7, 11, 1.5
#: Weights of Wang et al. 2004 that keep the quotients from vanishing.
K1, K2 = 0.01, 0.03
#: Differences above this many levels are counted as visible.
VISIBLE = 2.0


@dataclass(frozen=True)
class ImageMetrics:
    """How far one image is from another.

    Attributes
    ----------
    psnr : float
        Peak signal-to-noise ratio in dB; infinite for equal images.
    ssim : float
        Structural similarity, 1 for equal images.
    mean_difference, max_difference : float
        Of the absolute difference over all pixels and channels, in levels of 0..255.
    rms_difference : float
        Root of the mean squared difference, in levels.
    visible_share : float
        Share of pixels of which a channel differs by more than 2 levels, 0..1.
    max_position : tuple of 2 ints
        Column and row (from the top) of the largest difference.
    shift : tuple of 2 floats
        By how many pixels the second image lies further right and further down, see `image_shift`.
    """

    psnr: float
    ssim: float
    mean_difference: float
    max_difference: float
    rms_difference: float
    visible_share: float
    max_position: tuple[int, int]
    shift: tuple[float, float] = (0.0, 0.0)


def compare_images(first: Array, second: Array) -> ImageMetrics:
    """All metrics of a pair of images.

    Parameters
    ----------
    first, second : ndarray of shape (H, W), (H, W, 3) or (H, W, 4), uint8 or float
        Of one size, at least 7 x 7 pixels.

    Raises
    ------
    InputError
        Images of different or unusable shapes.
    """
    a, b = _pair(first, second)
    difference = np.abs(a - b)
    by_pixel = difference.max(axis=-1)
    row, column = np.unravel_index(int(np.argmax(by_pixel)), by_pixel.shape)
    error = float(np.mean(difference**2))
    return ImageMetrics(
        psnr=_psnr(error),
        ssim=float(np.mean(_ssim(a, b, gaussian=False)[1])),
        mean_difference=LEVELS * float(difference.mean()),
        max_difference=LEVELS * float(by_pixel.max()),
        rms_difference=LEVELS * math.sqrt(error),
        # a difference of exactly two levels comes out a little above it
        visible_share=float(np.mean(LEVELS * by_pixel > VISIBLE + 1e-6)),
        max_position=(int(column), int(row)),
        shift=_shift(a, b),
    )


def image_shift(first: Array, second: Array) -> tuple[float, float]:
    """By how many pixels the second image lies further right and further down than the first.

    The small shift that explains most of the difference, by least squares (Lucas and Kanade 1981, over the whole
    image): good to a hundredth of a pixel for images that differ by less than a pixel, not meant for larger
    shifts. Two renderers that place a volume alike have a shift near zero, however much they differ otherwise.

    Parameters
    ----------
    first, second : ndarray
        See the top of the module.

    Returns
    -------
    tuple of 2 floats
        (right, down); (0, 0) where the images are too plain to tell.
    """
    return _shift(*_pair(first, second))


def psnr(first: Array, second: Array) -> float:
    """Peak signal-to-noise ratio in dB over all pixels and channels, infinite for equal images."""
    a, b = _pair(first, second)
    return _psnr(float(np.mean((a - b) ** 2)))


def ssim(first: Array, second: Array, *, gaussian: bool = False) -> float:
    """Mean structural similarity (Wang et al. 2004) over all pixels whose window lies in the image.

    Parameters
    ----------
    first, second : ndarray
        See the top of the module; at least 7 x 7 pixels, 11 x 11 with `gaussian`.
    gaussian : bool, default: False
        Weigh each window by a Gaussian of sigma 1.5, as Wang et al. do, instead of a plain square of 7 x 7.

    Returns
    -------
    float
        -1..1; colours are averaged.
    """
    a, b = _pair(first, second)
    return float(np.mean(_ssim(a, b, gaussian=gaussian)[1]))


def ssim_map(first: Array, second: Array, *, gaussian: bool = False) -> Float64Array:
    """Structural similarity around every pixel, channels averaged; shape (H, W), -1..1."""
    a, b = _pair(first, second)
    return np.asarray(_ssim(a, b, gaussian=gaussian)[0].mean(axis=-1))


def luminance(image: Array) -> Float64Array:
    """Luma of an image with the weights of Rec. ITU-R BT.709, shape (H, W), 0..1."""
    values = as_float(image)
    if values.shape[-1] == 1:
        return values[..., 0]
    return np.asarray(values @ np.array([0.2126, 0.7152, 0.0722]))


@dataclass(frozen=True)
class Difference:
    """The difference of two images, as numbers and as an image.

    Attributes
    ----------
    values : ndarray of shape (H, W) or (H, W, 3), float64
        Second minus first in levels (-255..255), or its absolute value.
    limit : float
        Difference in levels that is drawn with the last colour.
    kind : {"absolute", "signed"}
    image : ndarray of shape (H, W, 3), uint8
        The values in colours; row 0 at the top.
    """

    values: Float64Array
    limit: float
    kind: Kind
    image: npt.NDArray[np.uint8]


#: Share of the pixels that the colours of a map are meant for: single ones may lie far beyond.
COLORED_SHARE = 0.999
#: Loss of structural similarity that a map shows in its strongest colour at least.
LEAST_LOSS = 0.01

Kind = Literal["absolute", "signed"]
Channel = Literal["rgb", "luminance", "red", "green", "blue"]
KINDS: tuple[Kind, ...] = ("absolute", "signed")
CHANNELS: tuple[Channel, ...] = ("rgb", "luminance", "red", "green", "blue")


def difference_image(
    first: Array,
    second: Array,
    *,
    kind: Kind = "absolute",
    channel: Channel = "luminance",
    limit: float | None = None,
) -> Difference:
    """What the second image has that the first has not, made visible.

    Parameters
    ----------
    first, second : ndarray
        See the top of the module.
    kind : {"absolute", "signed"}, default: "absolute"
        Absolute: dark where both are the same. Signed: grey where both are the same.
    channel : {"rgb", "luminance", "red", "green", "blue"}, default: "luminance"
        "rgb" keeps the channels as colours of the difference; the others are drawn with `color_table`.
    limit : float, optional
        Difference in levels of 0..255 that is drawn with the last colour, greater than 0; the default is the
        largest difference, but at least 1 level, so that rounding does not look like a fault.

    Raises
    ------
    InputError
        Unequal shapes, or an argument that is none of these.
    """
    if kind not in KINDS:
        raise InputError(f"kind of a difference is one of {', '.join(KINDS)}, got {kind!r}.")
    if channel not in CHANNELS:
        raise InputError(f"channel of a difference is one of {', '.join(CHANNELS)}, got {channel!r}.")
    a, b = _pair(first, second)
    values = LEVELS * (_channel(b, channel) - _channel(a, channel))
    if kind == "absolute":
        values = np.abs(values)
    if limit is None:
        limit = max(float(np.abs(values).max()), 1.0)
    elif not limit > 0 or not math.isfinite(limit):
        raise InputError(f"limit of a difference must be a number of levels above 0, got {limit!r}.")
    share = np.clip(values / limit, -1.0, 1.0)
    if kind == "signed":
        share = 0.5 + 0.5 * share
    if channel == "rgb":
        shown = np.rint(255.0 * share).astype(np.uint8)
    else:
        table = color_table(kind)
        shown = table[np.rint(share * (len(table) - 1)).astype(np.intp)]
    return Difference(values, float(limit), kind, np.ascontiguousarray(shown))


def color_table(kind: Kind) -> npt.NDArray[np.uint8]:
    """256 colours of a difference, shape (256, 3): from 0 to the limit, or from -limit to +limit.

    Perceptually even maps: inferno (Smith and van der Walt 2015), and vik (Crameri 2018), which is pale at zero.
    """
    import cmap

    colors = cmap.Colormap("inferno" if kind == "absolute" else "crameri:vik")(np.linspace(0.0, 1.0, 256))
    return np.rint(255.0 * np.asarray(colors)[:, :3]).astype(np.uint8)


def similarity_image(values: Float64Array) -> npt.NDArray[np.uint8]:
    """A map of structural similarity in grey, shape (H, W, 3): white = 1, black = 0 and below."""
    grey = np.rint(255.0 * np.clip(values, 0.0, 1.0)).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=-1)


def dissimilarity_image(values: Float64Array) -> Difference:
    """What is lost of structural similarity, 1 - SSIM, in the colours of an absolute difference.

    Parameters
    ----------
    values : ndarray of shape (H, W)
        From `ssim_map`.

    Returns
    -------
    Difference
        Its limit is the loss that one place in a thousand goes beyond, at least 0.01: what nobody sees shall not look
        like much.
    """
    lost = np.maximum(1.0 - values, 0.0)
    limit = max(float(np.quantile(lost, COLORED_SHARE)), LEAST_LOSS)
    shown = color_table("absolute")[np.rint(255.0 * np.minimum(lost / limit, 1.0)).astype(int)]
    return Difference(lost, limit, "absolute", np.ascontiguousarray(shown))


def as_float(image: Array) -> Float64Array:
    """An image as float64 of shape (H, W, channels), 0..1, without alpha.

    Raises
    ------
    InputError
        Another shape or type.
    """
    values = np.asarray(image)
    if values.ndim == 2:
        values = values[..., None]
    if values.ndim != 3 or values.shape[-1] not in (1, 3, 4) or 0 in values.shape:
        raise InputError(f"a picture has shape (H, W), (H, W, 3) or (H, W, 4), got {np.shape(image)}.")
    values = values[..., :3]
    if values.dtype == np.uint8:
        return values / LEVELS
    if values.dtype.kind != "f":
        raise InputError(f"a picture holds uint8 from 0 to 255 or floats from 0 to 1, got {values.dtype}.")
    return values.astype(np.float64)


def _pair(first: Array, second: Array) -> tuple[Float64Array, Float64Array]:
    a, b = as_float(first), as_float(second)
    if a.shape != b.shape:
        raise InputError(
            f"pictures of one size can be compared; these have {a.shape[1]} x {a.shape[0]} pixels of {a.shape[2]} "
            f"channels and {b.shape[1]} x {b.shape[0]} of {b.shape[2]}."
        )
    return a, b


def _psnr(error: float) -> float:
    return math.inf if error == 0 else -10.0 * math.log10(error)


def _shift(a: Float64Array, b: Float64Array) -> tuple[float, float]:
    if min(a.shape[:2]) < 2:
        return 0.0, 0.0
    # slopes of the mean of both, so that swapping them only changes the sign
    down, right = np.gradient((a + b) / 2.0, axis=(0, 1))
    change = b - a
    xx, xy, yy = (right * right).sum(), (right * down).sum(), (down * down).sum()
    determinant = xx * yy - xy * xy
    if not determinant > 1e-9 * max(xx, yy) ** 2:
        return 0.0, 0.0
    x, y = -(right * change).sum(), -(down * change).sum()
    return float((yy * x - xy * y) / determinant), float((xx * y - xy * x) / determinant)


def _channel(image: Float64Array, channel: Channel) -> Float64Array:
    if image.shape[-1] == 1:
        return np.repeat(image, 3, axis=-1) if channel == "rgb" else image[..., 0]
    if channel == "rgb":
        return image
    if channel == "luminance":
        return luminance(image)
    return image[..., ("red", "green", "blue").index(channel)]


def _ssim(a: Float64Array, b: Float64Array, *, gaussian: bool) -> tuple[Float64Array, Float64Array]:
    """The map of all channels, and its part whose windows lie in the image."""
    # here: the window imports this module and compares images only on request
    from scipy import ndimage

    window = GAUSSIAN_WINDOW if gaussian else SQUARE_WINDOW
    if min(a.shape[:2]) < window:
        raise InputError(
            f"structural similarity needs pictures of at least {window} x {window} pixels, "
            f"got {a.shape[1]} x {a.shape[0]}."
        )

    def local(values: Float64Array) -> Float64Array:
        if gaussian:
            return np.asarray(
                ndimage.gaussian_filter(values, (SIGMA, SIGMA, 0), radius=(window // 2,) * 2 + (0,))
            )
        return np.asarray(ndimage.uniform_filter(values, (window, window, 1)))

    # the plain window estimates the variance of a sample, the Gaussian one that of the window itself
    sample = 1.0 if gaussian else window**2 / (window**2 - 1.0)
    mean_a, mean_b = local(a), local(b)
    variance_a = sample * (local(a * a) - mean_a * mean_a)
    variance_b = sample * (local(b * b) - mean_b * mean_b)
    covariance = sample * (local(a * b) - mean_a * mean_b)
    c1, c2 = K1**2, K2**2
    values = ((2.0 * mean_a * mean_b + c1) * (2.0 * covariance + c2)) / (
        (mean_a**2 + mean_b**2 + c1) * (variance_a + variance_b + c2)
    )
    border = window // 2
    return values, values[border : a.shape[0] - border, border : a.shape[1] - border]
