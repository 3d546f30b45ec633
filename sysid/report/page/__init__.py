"""One self-contained page of a fit, a diagnosis or a comparison: `report.html`.

Sections are gathered by pure functions from frozen results into plain dataclasses of numbers
and words, one section a file; `render` puts them into the templates.  Nothing on the page is
fetched from anywhere.
"""
