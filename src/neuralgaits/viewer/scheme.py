"""Light or dark as the visitor's browser is set to."""

FOLLOW = (
    '<img src="data:," alt="" hidden onerror="'
    # A bare URL is the document's here.
    "const here=new window.URL(window.location.href),asked=here.searchParams;"
    "const dark=window.matchMedia('(prefers-color-scheme: dark)').matches;"
    "if(dark&amp;&amp;!asked.has('darkMode')){asked.set('darkMode','');"
    "window.location.replace(here)}"
    '">'
)
"""HTML that loads the page again with viser's `?darkMode` where the browser asks for dark.

The server does not learn what a browser is set to, and viser has no setting that follows it. The
image is no image, so that the browser runs what stands in `onerror`; nothing is fetched.
"""


def colour(light: str, dark: str) -> str:
    """CSS of a text colour: the first declaration is for browsers that do not know the second."""
    return f"color:{light};color:light-dark({light},{dark})"
