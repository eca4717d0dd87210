"""The camera of each visitor: the whole scene in view, for any shape of the window."""

import math
from collections.abc import Sequence

import numpy as np
import viser

from neuralgaits.viewer import page_style

FOV = math.radians(40.0)
_PHONE_ASPECT = 0.7
"""Width of a window that is taken for a phone's, in its height, if it is less."""

Direction = tuple[float, float, float]
"""From the scene's middle to a camera, in its distance."""
Pose = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Position and target of a camera [m]."""


class Framing:
    """Camera poses that show the whole scene.

    Attributes:
        top: height of the scene [m].
        wide: its width [m].
        direction: direction in which the camera stands.
    """

    def __init__(self, top: float, wide: float, direction: Direction = (-0.06, -1.0, 0.06)):
        self.top = top
        self.wide = wide
        self.direction = direction

    def of_window(self, width: int, height: int) -> Pose:
        """Return the pose for a window in pixels; for the usual one if its size is unknown."""
        has_size = width > 0 and height > 0
        aspect = width / height if has_size else 1.2
        # A browser tells its screen's own pixels, on a phone two or three for each of the page's.
        is_phone = has_size and (width <= page_style.PHONE_PX or aspect < _PHONE_ASPECT)
        share = page_style.SCENE_SHARE if is_phone else 1.0
        middle = 0.45 * self.top
        tall = max(self.top / share, self.wide / aspect)
        away = 0.5 * tall / math.tan(0.5 * FOV)
        ahead, aside, above = self.direction
        position = (ahead * away, aside * away, middle + above * away)
        # The scene is in the upper share of the window.
        return position, (0.0, 0.0, middle - 0.5 * (1.0 - share) * tall)

    def follow(self, server: viser.ViserServer) -> None:
        """Frame the scene for each visitor and each new window size, until they move the camera."""
        first = self.of_window(0, 0)
        server.initial_camera.fov = FOV
        server.initial_camera.position, server.initial_camera.look_at = first

        @server.on_client_connect
        def _(client: viser.ClientHandle) -> None:
            camera = client.camera
            # A page may still be at its own first view, and go to the server's after this one.
            ours = [np.array(camera.position), np.array(first[0])]

            def frame() -> None:
                pose = self.of_window(camera.image_width, camera.image_height)
                place = np.array(pose[0])
                here = _is_one_of(camera.position, [place])
                if ours and _is_one_of(camera.position, ours) and not here:
                    ours.append(place)
                    camera.position, camera.look_at = pose

            @camera.on_update
            def _(_: viser.CameraHandle) -> None:
                if not _is_one_of(camera.position, ours):
                    # The visitor's own view from now on.
                    ours.clear()
                frame()

            frame()


def _is_one_of(place: Sequence[float] | np.ndarray, known: list[np.ndarray]) -> bool:
    # Positions arrive in single precision.
    return any(np.max(np.abs(np.asarray(place) - one)) < 1e-3 for one in known)
