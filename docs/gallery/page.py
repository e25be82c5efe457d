"""Pictures of an experiment's page.

page.py REPORT.html PICTURE.png    the top of the page, with the motion halfway
page.py REPORT.html FOLDER         a sweep over the robots that come with the program: each as FOLDER/ROBOT.png
"""

import base64
import io
import sys
from pathlib import Path

from browser import chromium, picture  # tests/page
from PIL import Image
from playwright.sync_api import Page

# Keys that turn the view, and for each robot the time of its motion [‰].
TURN = ["ArrowLeft"] * 3
ROBOTS = {
    "xiao2023": 1000,
    "ets_vii": 1000,
    "canadarm2": 0,
    "panda": 1000,
    "ur5e": 750,
    "iiwa": 1000,
    "dual_arm": 1000,
}


def go(page: Page, time: int) -> None:
    """Moves the slider without the focus, which would be seen and scroll the page."""
    script = "(slider, time) => { slider.value = time; slider.dispatchEvent(new Event('input')); }"
    page.locator("[data-part=scrub]").evaluate(script, time)


def save(image: Image.Image, path: Path) -> None:
    image.convert("RGB").quantize(256).save(path, optimize=True)


def top(page: Page, path: Path) -> None:
    go(page, 500)
    motion = page.locator("#motion").bounding_box()
    page.set_viewport_size({"width": 1280, "height": int(motion["y"] + motion["height"])})
    save(Image.open(io.BytesIO(page.screenshot())), path)


def robots(page: Page, folder: Path) -> None:
    folder.mkdir(exist_ok=True)
    canvas = page.locator("canvas")
    for robot, time in ROBOTS.items():
        page.locator("[data-part=instance]").select_option(f"robot={robot}")
        for key in ["Home", *TURN]:
            canvas.press(key)
        go(page, time)
        image = Image.open(io.BytesIO(base64.b64decode(picture(page).partition(",")[2])))
        margin = (image.width - image.height) // 2
        save(image.crop((margin, 0, margin + image.height, image.height)), folder / f"{robot}.png")


report, target = map(Path, sys.argv[1:])
with chromium() as browser:
    context = browser.new_context(viewport={"width": 1280, "height": 900}, reduced_motion="reduce")
    page = context.new_page()
    page.goto(report.resolve().as_uri())
    page.wait_for_selector("html[data-ready]", state="attached")
    if target.suffix:
        top(page, target)
    else:
        robots(page, target)
