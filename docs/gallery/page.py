"""A picture of the top of an experiment's page, with the motion halfway: page.py REPORT.html PICTURE.png"""

import io
import sys
from pathlib import Path

from browser import chromium  # tests/page
from PIL import Image

HALFWAY = "e => { e.value = 500; e.dispatchEvent(new Event('input')); }"

report, picture = map(Path, sys.argv[1:])
with chromium() as browser:
    context = browser.new_context(viewport={"width": 1280, "height": 900}, reduced_motion="reduce")
    page = context.new_page()
    page.goto(report.resolve().as_uri())
    page.wait_for_selector("html[data-ready]", state="attached")
    page.locator("[data-part=scrub]").evaluate(HALFWAY)
    motion = page.locator("#motion").bounding_box()
    page.set_viewport_size({"width": 1280, "height": int(motion["y"] + motion["height"])})
    shot = page.screenshot()
Image.open(io.BytesIO(shot)).convert("RGB").quantize(256).save(picture, optimize=True)
