"""A picture of cells in axes, each pixel the colour of the cell under its centre.

Matplotlib's own images come out the same, but on the way to a picture of 1200 x 1200 pixels they
take 100 MB of floating-point numbers, as much as all of a mapper.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.image import AxesImage
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

OPAQUE = 255


class CellImage(AxesImage):
    """An image ``(rows, columns, 3)`` of bytes, row 0 at the bottom."""

    def __init__(
        self,
        ax: Axes,
        colours: NDArray[np.uint8],
        extent: tuple[float, float, float, float],
    ) -> None:
        """Show colours in axes.

        Args:
            ax: The axes; their limits are left as they are.
            colours: The image.
            extent: Its edges in the axes' units: left, right, bottom, top.
        """
        super().__init__(ax, extent=extent, origin="lower", interpolation="nearest", zorder=0)
        self.set_data(colours)
        ax.add_image(self)
        self.set_clip_path(ax.patch)

    def make_image(
        self, renderer: RendererBase, magnification: float = 1.0, unsampled: bool = False
    ) -> tuple[NDArray[np.uint8], float, float, Affine2D]:
        """The pixels ``(height, width, 4)`` of the axes, and their lower-left corner."""
        if magnification != 1.0 or unsampled:  # a file of lines, not of pixels
            return super().make_image(renderer, magnification, unsampled)
        assert self.axes is not None
        box, colours = self.axes.bbox, np.asarray(self.get_array())
        left, right, bottom, top = self.get_extent()
        (x0, y0), (x1, y1) = self.axes.transData.transform([(left, bottom), (right, top)])
        first_x, first_y = int(np.floor(box.x0)), int(np.floor(box.y0))
        columns, in_x = _cells(first_x, int(np.ceil(box.x1)), x0, x1, colours.shape[1])
        rows, in_y = _cells(first_y, int(np.ceil(box.y1)), y0, y1, colours.shape[0])
        pixels = np.zeros((len(rows), len(columns), 4), dtype=np.uint8)
        pixels[..., :3] = colours[rows[:, None], columns]
        pixels[..., 3] = OPAQUE * (in_y[:, None] & in_x)
        return pixels, float(first_x), float(first_y), Affine2D()


def _cells(
    first: int, end: int, begin: float, stop: float, count: int
) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Which of ``count`` cells between two places each pixel from first to end shows, if any."""
    cells = np.floor((np.arange(first, end) + 0.5 - begin) / (stop - begin) * count)
    shown = (cells >= 0) & (cells < count)
    return np.where(shown, cells, 0).astype(np.intp), shown
