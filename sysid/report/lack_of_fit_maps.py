"""Where the base model and the extended model are wrong, side by side in the same colours."""

from matplotlib.figure import Figure

from sysid.diagnosis.lack_of_fit import lack_of_fit
from sysid.diagnosis.result import Diagnosis
from sysid.report.before_after_plot import extended
from sysid.report.figure import png
from sysid.report.lack_of_fit_plot import plot_parity, plot_residual_map


def lack_of_fit_png(diagnosis: Diagnosis) -> bytes:
    """Maps of the residual and its kinds, before and (where something was added) after, as PNG."""
    loops = diagnosis.loops
    cases = {"Base model": diagnosis.simulated_before}
    if extended(diagnosis):
        cases["Extended model"] = diagnosis.simulated_after
    figure = Figure(figsize=(7.5 * len(cases), 4.5 + 0.16 * len(loops.ids)), layout="constrained")
    heights = (2.0 + 0.16 * len(loops.ids), 2.0)
    grid = figure.subplots(2, len(cases), squeeze=False, gridspec_kw={"height_ratios": heights})
    limit = None
    for k, (title, simulated) in enumerate(cases.items()):
        found = lack_of_fit(loops, simulated)
        plot_residual_map(loops, found, ax=grid[0][k])
        image = grid[0][k].images[0]
        if limit is None:
            limit = image.get_clim()
        image.set_clim(*limit)
        grid[0][k].set_title(title, loc="left")
        plot_parity(found, ax=grid[1][k])
    return png(figure)
