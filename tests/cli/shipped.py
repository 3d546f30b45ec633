"""Copies of shipped tests, as small campaigns."""

from pathlib import Path

DATASETS = Path(__file__).parents[2] / "datasets"
LOW = DATASETS / "virtual-w11-low"


def some_tests(folder: Path, stems: list[str], sign: float = 1.0) -> None:
    folder.mkdir(parents=True)
    for stem in stems:
        lines = (LOW / f"{stem}.csv").read_text().splitlines()
        k = lines[0].split(",").index("force_N")
        rows = [line.split(",") for line in lines[1:]]
        for row in rows:
            row[k] = repr(sign * float(row[k]))
        text = "\n".join([lines[0], *(",".join(row) for row in rows)])
        (folder / f"{stem}.csv").write_text(text + "\n")
