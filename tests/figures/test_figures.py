"""Reads every figure of every experiment: test_figures.py RESULTS"""

import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import pikepdf
from PIL import Image
from pypdf import PdfReader

COLUMN, PAGE = 88.0, 180.0
POINTS_PER_MM = 72 / 25.4
SVG = "{http://www.w3.org/2000/svg}"

# A word that is in each figure, so that its text is text.
WORDS = {
    "acceleration-sweep": "acceleration", "base-attitude": "pitch", "convergence": "evaluations",
    "critical-difference": "Wilcoxon", "data-profiles": "simplex gradients",
    "dimensions": "variables", "effect-sizes": "lower",
    "expected-running-time": "expected", "final-costs": "final", "jerk-sweep": "jerk", "joint-angles": "joint",
    "joint-derivatives": "jerk", "pareto": "residual", "performance-profiles": "ratio",
    "rate-sweep": "rates", "running-time-distribution": "share", "snapshots": "t = 0.00 s",
    "terms-sweep": "coefficients", "weight-sweep": "weight",
}


def fonts(page):
    """Every font of a page, those within its forms too."""
    holders = [page]
    while holders:
        resources = holders.pop().get("/Resources", {})
        yield from (font for _, font in resources.get("/Font", {}).items())
        holders += [form for _, form in resources.get("/XObject", {}).items()]


def check_pdf(path):
    with pikepdf.open(path) as pdf:
        problems = pdf.check()
        assert not problems, problems
        assert len(pdf.pages) == 1
        width = float(pdf.pages[0].mediabox[2]) / POINTS_PER_MM
        assert min(abs(width - COLUMN), abs(width - PAGE)) < 0.1, f"{width} mm"
        found = list(fonts(pdf.pages[0].obj))
        assert found, "no font"
        for font in found:
            descriptor = font["/DescendantFonts"][0]["/FontDescriptor"]
            assert any(f"/FontFile{kind}" in descriptor for kind in ("", 2, 3)), "a font is not embedded"
            assert "/ToUnicode" in font, "a text cannot be searched"
    text = PdfReader(path).pages[0].extract_text()
    assert WORDS[path.stem] in text, f"{WORDS[path.stem]!r} is not in {text!r}"
    return width


def check_svg(path, width):
    root = xml.parse(path).getroot()
    assert root.tag == f"{SVG}svg"
    # The program writes sizes in CSS pixels, 96 an inch.
    assert abs(float(root.get("width")) / 96 * 25.4 - width) < 0.1
    tags = {element.tag.removeprefix(SVG) for element in root.iter()}
    assert "path" in tags and not tags & {"text", "image", "script", "style"}, tags
    references = [v for e in root.iter() for k, v in e.attrib.items() if k.endswith("href")]
    assert all(reference.startswith("#") for reference in references), references


def check_png(path, width):
    with Image.open(path) as image:
        image.load()
        assert all(abs(dpi - 300) < 0.01 for dpi in image.info["dpi"]), image.info
        assert abs(image.width / 300 * 25.4 - width) < 0.1
        assert len(image.getcolors(1 << 24)) > 2


def main(results):
    names = set()
    figures = sorted(results.glob("*/figures/*.pdf"))
    for path in figures:
        try:
            width = check_pdf(path)
            check_svg(path.with_suffix(".svg"), width)
            check_png(path.with_suffix(".png"), width)
        except AssertionError as error:
            sys.exit(f"{path}: {error}")
        names.add(path.stem)
    print(f"{len(figures)} figures of {len(names)} kinds, each as PDF, SVG and PNG: all as they should be")
    # Sweeps over rates and accelerations come with no experiment.
    missing = set(WORDS) - names - {"acceleration-sweep", "rate-sweep"}
    return f"not drawn: {sorted(missing)}" if missing else None


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
