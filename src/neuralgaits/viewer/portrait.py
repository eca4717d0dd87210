"""Phase portrait of the zero dynamics as a picture in which each pixel is a state.

Its ground is transparent, and its inks can be read on a light page and on a dark one.
"""

from dataclasses import dataclass

import numpy as np

from neuralgaits._types import Float
from neuralgaits.analysis.box_map import BoxAnswer, BoxMap

WIDTH_PX, HEIGHT_PX = 1320, 850
"""Size of the picture."""
_CORNER = np.array([0.08, 0.235])
"""Lower left corner of the plane, as shares of the picture."""
_SIZE = np.array([0.91, 0.67])
"""Size of the plane, as shares of the picture."""
WALK = "#2f7fd0"
"""Colour of the walk; as on the report, it is blue, and the orbit is orange."""
_FLOW, _INK, _ORBIT, _GUARD = "#848c95", "#767d86", "#d55e00", "#a066c4"
_GREENS = ("#b5dcb8", "#7fc18c", "#3d8c57")
"""Colours of margins, from none to the largest."""
_UNDECIDED, _REFUTED = "#f0a040", "#d0664c"


@dataclass(frozen=True)
class Portrait:
    """Data of the phase plane, complete before the robot moves.

    Attributes:
        z1, z2: grid of the flow [m], [kg m^2/s]. [A], [B]
        dz: rates on the grid (m/s, N m). [B, A, 2]
        fence_z1: z1 along both fences [m]. [P]
        fence_z2: lower and upper fence [kg m^2/s]. [2, P]
        orbit: orbit from landing to landing; no rows if there is none. [T, 2]
        boxes: what is known of the region, box by box.
        title: one line that says where the margins are from.
    """

    z1: Float[np.ndarray, " A"]
    z2: Float[np.ndarray, " B"]
    dz: Float[np.ndarray, "B A 2"]
    fence_z1: Float[np.ndarray, " P"]
    fence_z2: Float[np.ndarray, "2 P"]
    orbit: Float[np.ndarray, "T 2"]
    boxes: BoxMap
    title: str

    @property
    def low(self) -> Float[np.ndarray, "2"]:
        """Return the least z in view. [2]."""
        return np.array([self.z1[0], self.z2[0]])

    @property
    def high(self) -> Float[np.ndarray, "2"]:
        """Return the largest z in view. [2]."""
        return np.array([self.z1[-1], self.z2[-1]])

    def place(self, z: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        """Return places of states in the picture, as shares of it from its lower left corner."""
        share = (z - self.low) / (self.high - self.low)
        return _CORNER + share * _SIZE

    def state(self, place: Float[np.ndarray, "2"]) -> Float[np.ndarray, "2"]:
        """Return the state at a place of the picture; the inverse of `place`."""
        return self.low + (place - _CORNER) / _SIZE * (self.high - self.low)

    def clip(self, z: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        """Return the nearest states in view."""
        return np.clip(z, self.low, self.high)

    def in_view(self, z: Float[np.ndarray, "... 2"]) -> np.ndarray:
        """Return whether states are on the plane that the picture shows. [...]."""
        return np.all((z >= self.low) & (z <= self.high), axis=-1)

    def beyond(self, z: Float[np.ndarray, "2"]) -> str | None:
        """Return in words on which side a state is off the picture; None if it is in view."""
        sides = (
            (z[1] > self.high[1], "▲ above the chart"),
            (z[1] < self.low[1], "▼ below the chart"),
            (z[0] < self.low[0], "◄ left of the chart"),
            (z[0] > self.high[0], "► right of the chart"),
        )
        return next((words for is_there, words in sides if is_there), None)

    def draw(self) -> np.ndarray:
        """Draw the picture: red, green, blue and opacity. [HEIGHT_PX, WIDTH_PX, 4]."""
        # Half a second of imports that the first frame does not wait for.
        import matplotlib as mpl

        with mpl.rc_context():
            # A `matplotlibrc` of the user's or of the folder has no part in it.
            mpl.rcdefaults()
            return self._drawn()

    def _drawn(self) -> np.ndarray:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        dpi = 150
        size = WIDTH_PX / dpi, HEIGHT_PX / dpi
        figure = Figure(figsize=size, dpi=dpi, facecolor="none")
        axes = figure.add_axes((*_CORNER, *_SIZE), facecolor="none")
        self._draw_boxes(axes)
        speed = np.where(np.isfinite(self.dz), self.dz, 0.0)
        axes.streamplot(
            self.z1,
            self.z2,
            speed[..., 0],
            speed[..., 1],
            density=(1.1, 0.7),
            color=_FLOW,
            linewidth=0.7,
            arrowsize=0.8,
        )
        for fence in self.fence_z2:
            axes.plot(self.fence_z1, fence, color=_INK, linewidth=2.2)
        for end, style in ((0, ":"), (-1, "--")):
            axes.plot(self.fence_z1[[end, end]], self.fence_z2[:, end], style, color=_GUARD, lw=2.4)
        if len(self.orbit):
            # Wider than the walk that is drawn over it.
            axes.plot(*self.orbit.T, color=_ORBIT, linewidth=5.0)
            first, last = self.orbit[0], self.orbit[-1]
            axes.annotate(
                "",
                first,
                last,
                arrowprops={"arrowstyle": "->", "color": _ORBIT, "ls": ":", "lw": 1.6},
            )
        self._label(axes)
        self._add_legend(figure)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        return np.array(canvas.buffer_rgba())

    def _draw_boxes(self, axes) -> None:
        from matplotlib.collections import PolyCollection
        from matplotlib.colors import LinearSegmentedColormap, to_rgba

        boxes = self.boxes
        greens = LinearSegmentedColormap.from_list("margin", _GREENS)
        colours = greens(np.clip(boxes.margin / self._top_margin, 0.0, 1.0))
        colours[boxes.answer == BoxAnswer.UNDECIDED] = to_rgba(_UNDECIDED)
        colours[boxes.answer == BoxAnswer.REFUTED] = to_rgba(_REFUTED)
        flat = boxes.drawn_last[~boxes.curved[boxes.drawn_last]]
        polygons = PolyCollection(list(boxes.corners[flat]), linewidths=0.3)
        polygons.set(facecolors=colours[flat], edgecolors=colours[flat])
        axes.add_collection(polygons)

    @property
    def _top_margin(self) -> float:
        """Return the margin that has the darkest green [scale of its condition]."""
        green = self.boxes.answer == BoxAnswer.PROVED
        return float(np.max(self.boxes.margin[green], initial=1e-6))

    def _add_legend(self, figure) -> None:
        """Say below the plane what its lines and fills are."""
        from matplotlib.lines import Line2D
        from matplotlib.patches import Patch

        handles: list = [Line2D([], [], color=WALK, linewidth=3.0, label="this walk")]
        if len(self.orbit):
            words = "periodic orbit; dotted: its reset"
            handles.append(Line2D([], [], color=_ORBIT, linewidth=5.0, label=words))
        handles.append(Line2D([], [], color=_INK, linewidth=2.2, label="edge of the region"))
        handles.append(Line2D([], [], color=_FLOW, linewidth=0.8, marker=">", ms=4, label="flow"))
        answers = self.boxes.answer
        if np.any(answers == BoxAnswer.PROVED):
            least = f"least margin, 0 (pale) to {self._top_margin:.2f} (dark)"
            handles.append(Patch(facecolor=_GREENS[1], label=least))
        if np.any(answers == BoxAnswer.UNDECIDED):
            handles.append(Patch(facecolor=_UNDECIDED, label="undecided"))
        if np.any(answers == BoxAnswer.REFUTED):
            handles.append(Patch(facecolor=_REFUTED, label="below 0"))
        legend = {"frameon": False, "labelcolor": _INK, "prop": {"size": 10.5, "weight": "bold"}}
        place = {"loc": "lower center", "bbox_to_anchor": (0.5, 0.0)}
        figure.legend(handles=handles, ncols=3, columnspacing=1.4, **place, **legend)

    def _label(self, axes) -> None:
        axes.set(xlim=(self.z1[0], self.z1[-1]), ylim=(self.z2[0], self.z2[-1]))
        axes.set_xlabel(
            "z1, hip ahead of the stance foot [m]", fontsize=12, labelpad=2, weight="bold"
        )
        axes.set_ylabel("z2, angular momentum [kg m²/s]", fontsize=12, labelpad=2, weight="bold")
        axes.tick_params(labelsize=10, colors=_INK)
        axes.xaxis.label.set_color(_INK)
        axes.yaxis.label.set_color(_INK)
        for spine in axes.spines.values():
            spine.set_color(_INK)
        axes.set_title(self.title, fontsize=12.5, color=_INK, pad=8, weight="bold")
        for tick in (*axes.get_xticklabels(), *axes.get_yticklabels()):
            tick.set_fontweight("bold")
        for end, word in ((0, "after\nimpact"), (-1, "guard")):
            x, y = self.fence_z1[end], self.fence_z2[1, end]
            axes.annotate(
                word,
                (x, y),
                (0, 6),
                textcoords="offset points",
                ha="center",
                fontsize=10.5,
                weight="bold",
                color=_GUARD,
            )
