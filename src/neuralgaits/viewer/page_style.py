"""Style of the live page on top of viser's, and how a phone's window is divided.

Another version of viser that names its parts otherwise is shown as it is.
"""

PHONE_PX = 576
"""Largest width of a window whose controls are a sheet below the scene; viser's own."""
SCENE_SHARE = 0.5
"""Share of a phone's window that the scene has to itself."""
_SHEET = '.mantine-Paper-root[style*="bottom: 0px"]'
# By itself the sheet covers two thirds of the width and three fifths of the height.
STYLE = (
    "<style>code { overflow-wrap: anywhere; } p + p { margin-top: 0.5em !important; } "
    f"@media (max-width: {PHONE_PX}px) {{"
    f"{_SHEET} {{ width: 100% !important; max-height: {100.0 * SCENE_SHARE:.0f}% !important; }} "
    f'{_SHEET} div[style="width: 20em;"] {{ width: 100% !important; }}'
    "}</style>"
)
"""HTML that wraps long commands, parts paragraphs and widens a phone's controls to its window."""
