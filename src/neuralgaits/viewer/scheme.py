"""Light or dark scheme, as the visitor's browser is set."""

FOLLOW = (
    '<img src="data:," alt="" hidden onerror="'
    # A bare URL is the document's here.
    "const here=new window.URL(window.location.href),asked=here.searchParams;"
    "const dark=window.matchMedia('(prefers-color-scheme: dark)').matches;"
    "if(dark&amp;&amp;!asked.has('darkMode')){asked.set('darkMode','');"
    "window.location.replace(here)}"
    '">'
)
"""HTML that reloads the page with viser's `?darkMode` if the browser prefers dark.

The server does not learn a browser's preference, and viser has no setting that follows it. The
image is invalid on purpose, so that the browser runs the code in `onerror`; nothing is fetched.
"""


def colour(light: str, dark: str) -> str:
    """Return CSS of a text colour; browsers without `light-dark` use the first declaration."""
    return f"color:{light};color:light-dark({light},{dark})"
