"""A page in a browser without a window, and what it is asked."""

import shutil
import time
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--hide-scrollbars"]


class Checks:
    """Counts what holds, and keeps what does not."""

    def __init__(self):
        self.made = 0
        self.failed = []

    def that(self, holds, message):
        self.made += 1
        if not holds:
            self.failed.append(message)
            print(f"FAILED {message}", flush=True)

    def equal(self, found, expected, message):
        self.that(found == expected, f"{message}: found {found!r:.200}, expected {expected!r:.200}")


@contextmanager
def chromium():
    with sync_playwright() as playwright:
        path = shutil.which("chromium")
        browser = playwright.chromium.launch(executable_path=path, args=ARGUMENTS)
        yield browser
        browser.close()


@contextmanager
def opened(browser, path: Path, checks: Checks, width=1280, scheme="light"):
    """The page, once it is ready; whatever it says on the console or asks of the network is a failure."""
    context = browser.new_context(
        viewport={"width": width, "height": 900}, color_scheme=scheme, reduced_motion="reduce"
    )
    page = context.new_page()
    said, asked = [], []
    page.on("console", lambda m: said.append(m.text) if m.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    address = path.resolve().as_uri()
    page.goto(address)
    page.wait_for_selector("html[data-ready]", state="attached", timeout=30_000)
    yield page
    checks.equal(said, [], f"{path}: said on the console")
    others = [url for url in asked if url != address and not url.startswith("blob:")]
    checks.equal(others, [], f"{path}: asked for")
    context.close()


def picture(page: Page) -> str:
    """What the canvas shows."""
    return page.evaluate("document.querySelector('canvas').toDataURL()")


def downloaded(page: Page, button) -> bytes:
    # Chromium drops what comes faster than some ten in a second.
    time.sleep(0.12)
    with page.expect_download() as download:
        button.click()
    return Path(download.value.path()).read_bytes()


def names_missing(page: Page) -> list[str]:
    """Roles that need an accessible name, of nodes that have none, as the browser works them out."""
    needed = {
        "button", "searchbox", "textbox", "combobox", "slider", "checkbox", "figure", "img", "image",
        "meter", "region", "table", "link", "navigation",
    }
    session = page.context.new_cdp_session(page)
    nodes = session.send("Accessibility.getFullAXTree")["nodes"]
    session.detach()
    seen = [
        (node["role"]["value"], node.get("name", {}).get("value", ""))
        for node in nodes
        if not node.get("ignored") and "role" in node
    ]
    assert sum(role in needed for role, _ in seen) > 20, "the tree of accessible nodes is empty"
    return [role for role, name in seen if role in needed and not name.strip()]


# For every text that is seen: its colour against the background behind it (WCAG 2.2, relative luminance).
POOR_CONTRAST = """() => {
  const luminance = ([r, g, b]) => {
    const part = (c) => (c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
    return 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
  };
  const numbers = (colour) => colour.match(/[\\d.]+/g).map(Number);
  const behind = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const colour = numbers(getComputedStyle(e).backgroundColor);
      if (colour.length === 3 || colour[3] > 0) return colour;
    }
    return [255, 255, 255];
  };
  const poor = [];
  for (const element of document.body.querySelectorAll("*")) {
    const own = [...element.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
    if (!own || !element.checkVisibility() || ["SCRIPT", "STYLE", "NOSCRIPT"].includes(element.tagName)) continue;
    const [a, b] = [luminance(numbers(getComputedStyle(element).color)), luminance(behind(element))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) poor.push(`${element.tagName} ${element.className} ${ratio.toFixed(2)}`);
  }
  return poor;
}"""

REPEATED_IDS = """() => {
  const ids = [...document.querySelectorAll("[id]")].map((e) => e.id);
  return ids.filter((id, i) => ids.indexOf(id) !== i);
}"""

DANGLING = """() => [...document.querySelectorAll("[aria-labelledby], [aria-describedby], label[for], a[href^='#']")]
  .flatMap((e) => ["aria-labelledby", "aria-describedby", "for"].flatMap((k) => (e.getAttribute(k) ?? "").split(" "))
    .concat(e.getAttribute("href")?.slice(1) ?? ""))
  .filter((id) => id && !document.getElementById(id))"""

HEADINGS = """() => [...document.querySelectorAll("h1, h2, h3, h4")].map((h) => Number(h.tagName[1]))"""

# Everything that takes the focus, and whether it did so since the marks were taken off.
FOCUSABLE = "a[href], button, input, select, [tabindex='0']"
UNREACHED = f"""() => [...document.querySelectorAll("{FOCUSABLE}")]
  .filter((e) => e.checkVisibility() && !e.hidden && !e.dataset.reached).map((e) => e.outerHTML.slice(0, 90))"""
