"""Opens every experiment's page from the disk and does what a reader can do: test_page.py RESULTS PICTURES AXE"""

import base64
import gzip
import math
import os
import re
import sys
import time
import xml.etree.ElementTree as xml
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import stored
from browser import (
    DANGLING, HEADINGS, POOR_CONTRAST, REPEATED_IDS, UNREACHED, Checks, chromium, downloaded, names_missing,
    opened, picture,
)

MOST_BYTES = 5_000_000
FIRST_ROWS = 50


def check_structure(page, checks, name, axe):
    checks.equal(page.evaluate(REPEATED_IDS), [], f"{name}: identifiers that stand twice")
    checks.equal(page.evaluate(DANGLING), [], f"{name}: references to nothing")
    checks.equal(names_missing(page), [], f"{name}: roles without a name")
    levels = page.evaluate(HEADINGS)
    checks.equal(levels[0], 1, f"{name}: first heading")
    checks.that(all(b <= a + 1 for a, b in zip(levels, levels[1:])), f"{name}: headings skip a level")
    checks.equal(page.evaluate("document.documentElement.lang"), "en", f"{name}: language")
    if axe.exists():
        page.evaluate(axe.read_text())
        found = page.evaluate("axe.run().then(r => r.violations.map(v => v.id + ': ' + v.nodes[0].html))")
        checks.equal(found, [], f"{name}: axe")


def check_keyboard(page, checks, name):
    """Tab goes everywhere, from the link that skips the header on."""
    page.evaluate("window.scrollTo(0, 0); document.activeElement?.blur()")
    page.evaluate("document.addEventListener('focusin', (e) => (e.target.dataset.reached = 1))")
    count = len(page.evaluate(UNREACHED))
    for _ in range(count + 3):
        page.keyboard.press("Tab")
    checks.equal(page.evaluate(UNREACHED), [], f"{name}: not reached by Tab")


def check_looks(browser, path, checks, pictures):
    for width in (1280, 400):
        for scheme in ("light", "dark"):
            with opened(browser, path, checks, width, scheme) as page:
                name = f"{path.parent.name} {width} {scheme}"
                wide = page.evaluate("document.documentElement.scrollWidth")
                checks.that(wide <= width, f"{name}: {wide} px wide")
                checks.equal(page.evaluate(POOR_CONTRAST), [], f"{name}: poor contrast")
                page.screenshot(path=pictures / f"{path.parent.name}-{width}-{scheme}.png", full_page=True)
                button = page.locator("#theme")
                before = page.evaluate("getComputedStyle(document.body).backgroundColor")
                button.click()
                after = page.evaluate("getComputedStyle(document.body).backgroundColor")
                checks.that(before != after, f"{name}: the button changes no colour")
                checks.equal(page.evaluate(POOR_CONTRAST), [], f"{name}: poor contrast after the button")


def column_texts(section, column):
    return section.locator(f"tbody tr td:nth-child({column + 1})").all_inner_texts()


def check_table(page, section, checks, name, table):
    header = [text.strip() for text in section.locator("thead th button").all_inner_texts()]
    checks.equal(header, table.shown_header, f"{name}: columns")
    rows = [row.split("\t") for row in section.locator("tbody").inner_text().split("\n") if row]
    expected = [[re.sub(r"\s+", " ", c) for c in row] for row in table.shown[:FIRST_ROWS]]
    checks.equal([[c.strip() for c in row] for row in rows], expected, f"{name}: cells")
    for i, column in enumerate(header):
        button = section.locator("thead th button").nth(i)
        for descending in (False, True):
            button.evaluate("button => button.click()")
            word = "descending" if descending else "ascending"
            state = section.locator("thead th").nth(i).get_attribute("aria-sort")
            checks.equal(state, word, f"{name}: {column} says how it is sorted")
            texts = column_texts(section, i)
            order = table.order(column, descending)
            if order is None:
                sorted_texts = page.evaluate(
                    "([texts, sign]) => texts.every((t, i) => !i || t === '' || texts[i - 1] !== '' && "
                    "sign * t.localeCompare(texts[i - 1], 'en', { numeric: true }) >= 0)",
                    [texts, -1 if descending else 1],
                )
                checks.that(sorted_texts, f"{name}: {column} {word}")
            else:
                expected = [table.shown[row][i] for row in order][:FIRST_ROWS]
                checks.equal(texts, expected, f"{name}: {column} {word}")
    check_filter(section, checks, name, table)
    content = downloaded(page, section.locator("[data-download]"))
    checks.that(content == table.bytes, f"{name}: downloaded bytes")


def check_filter(section, checks, name, table):
    box, count = section.locator("input"), section.locator("output")
    last = table.shown[-1]
    unit = "row" if len(table.rows) == 1 else "rows"
    for words in (last[0].split()[0], f"{last[-1]} {last[0]}".replace("–", ""), "no such word"):
        box.fill(words)
        found = table.matching(words)
        whole = found == len(table.rows)
        told = f"{found} {unit}" if whole else f"{found} of {len(table.rows)} {unit}"
        checks.equal(count.inner_text(), told, f"{name}: filtered by {words!r}")
        checks.equal(section.locator("tbody tr").count(), min(found, FIRST_ROWS), f"{name}: rows for {words!r}")
    box.fill("")


def check_tables(page, folder, checks):
    files = {path.stem for path in (folder / "tables").glob("*.md")}
    sections = page.locator(".table")
    names = [sections.nth(i).get_attribute("data-name") for i in range(sections.count())]
    checks.equal(set(names), files, f"{folder.name}: tables")
    for i, name in enumerate(names):
        table = stored.Table(folder / "tables", name)
        check_table(page, sections.nth(i), checks, f"{folder.name} {name}", table)


def check_files(page, folder, checks):
    for button in page.locator("#figures [data-download], .curves [data-download]").all():
        name = button.get_attribute("data-download")
        path = folder / "tables" / f"{name}.csv"
        if path.exists():
            checks.that(downloaded(page, button) == path.read_bytes(), f"{folder.name}: bytes of {name}")
    for figure in page.locator("figure").all():
        name = f"{folder.name} {figure.get_attribute('data-name')}"
        drawing = xml.fromstring(downloaded(page, figure.locator(".svg")))
        sizes = [float(drawing.get(side)) for side in ("width", "height")]
        content = downloaded(page, figure.locator(".png"))
        pixels = [int.from_bytes(content[at : at + 4], "big") for at in (16, 20)]
        checks.equal(content[:8], b"\x89PNG\r\n\x1a\n", f"{name}: PNG")
        checks.equal(pixels, [math.ceil(size * 300 / 96) for size in sizes], f"{name}: size at 300 dpi")
    for button in page.locator("[data-file]").all():
        name = button.get_attribute("data-name")
        checks.that(downloaded(page, button) == (folder / name).read_bytes(), f"{folder.name}: {name}")


def number(page, part):
    text = page.locator(f"[data-part='{part}']").inner_text()
    return float(text.replace("−", "-").rstrip("°"))


def check_ends(page, folder, checks):
    """At the end of every motion the numbers are those of the goal, up to the residual that the tables tell."""
    best = stored.Table(folder / "tables", "best")
    residuals = [float(row[best.header.index("residual [°]")]) for row in best.rows]
    durations = [float(row[best.header.index("t_f [s]")]) for row in best.rows]
    goal = stored.goal(folder)
    choice = page.locator("[data-part='instance']")
    for i, (residual, duration) in enumerate(zip(residuals, durations)):
        name = f"{folder.name} motion {i}"
        if choice.count():
            choice.select_option(index=i)
        scrub = page.locator("[data-part='scrub']")
        scrub.fill(scrub.get_attribute("max"))
        told = f"{duration:.2f} s of {duration:.2f} s"
        checks.equal(scrub.get_attribute("aria-valuetext"), told, f"{name}: time")
        error = number(page, "error")
        checks.that(abs(error - residual) < 0.0051, f"{name}: error {error}, residual {residual}")
        if goal:
            for part, value in zip(("yaw", "pitch", "roll"), goal):
                away = abs(number(page, part) - value)
                checks.that(away < residual + 0.0051, f"{name}: {part} is {away}° from the goal")
    return len(residuals)


def rotation(page):
    """The matrix of the base's attitude that the page tells, from Z-Y-X Euler angles."""
    yaw, pitch, roll = (math.radians(number(page, part)) for part in ("yaw", "pitch", "roll"))
    (cy, sy), (cp, sp), (cr, sr) = ((math.cos(a), math.sin(a)) for a in (yaw, pitch, roll))
    return [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]


def check_largest_turn(page, folder, checks):
    """The largest turn that is told is the largest angle between the attitudes that are shown and the first one."""
    told = re.search(r"up to ([0-9.]+)° from where it started", page.locator("[data-part='about']").inner_text())
    scrub = page.locator("[data-part='scrub']")
    turns, start = [], None
    for place in range(0, 1001, 20):
        scrub.fill(str(place))
        now = rotation(page)
        start = start or now
        trace = sum(a * b for first, second in zip(start, now) for a, b in zip(first, second))
        turns.append(math.degrees(math.acos(min(1.0, max(-1.0, (trace - 1.0) / 2.0)))))
    checks.that(told and abs(float(told[1]) - max(turns)) < 0.3, f"{folder.name}: {told and told[1]}°, shown {max(turns):.2f}°")


def check_worst_moments(page, folder, checks):
    """Every limit on the way has a mark on the time line, and a button that shows where most of it is used."""
    limits = stored.experiment(folder)["task"]["limits"]
    asked = {"base_turn_deg", "base_rate_deg_s"} & limits.keys()
    buttons = page.locator("[data-part='limited'] button")
    checks.equal(buttons.count(), len(asked), f"{folder.name}: worst moments")
    checks.equal(page.locator("[data-part='marks'] span").count(), len(asked), f"{folder.name}: marks")
    for i in range(buttons.count()):
        button = buttons.nth(i)
        at = float(re.search(r" at ([0-9.]+) s", button.inner_text())[1])
        button.click()
        shown = float(page.locator("[data-part='time']").inner_text().split()[0])
        checks.that(abs(shown - at) < 0.011, f"{folder.name}: {shown} s instead of {at} s")


def check_motion(page, folder, checks):
    name = folder.name
    canvas, play = page.locator("canvas"), page.locator("[data-part='play']")
    # From here on the page's clock goes by the test's hand, so that no load on the machine matters.
    page.clock.install(time=0)
    page.clock.pause_at(1)
    still = picture(page)
    page.clock.run_for(300)
    checks.that(picture(page) == still, f"{name}: moves without being asked")
    play.click()
    page.clock.run_for(400)
    first = picture(page)
    page.clock.run_for(400)
    checks.that(len({still, first, picture(page)}) == 3, f"{name}: does not move when played")
    play.click()
    paused = picture(page)
    page.clock.run_for(300)
    checks.that(picture(page) == paused, f"{name}: moves when paused")
    canvas.focus()
    page.keyboard.press("Space")
    checks.equal(play.inner_text(), "Pause", f"{name}: space plays")
    page.clock.run_for(300)
    page.keyboard.press("Space")
    checks.equal(play.inner_text(), "Play", f"{name}: space pauses")
    before = picture(page)
    checks.that(before != paused, f"{name}: space moves it")
    for key in ("ArrowLeft", "ArrowUp", "ArrowRight", "ArrowDown", "+", "-"):
        earlier = picture(page)
        page.keyboard.press(key)
        checks.that(picture(page) != earlier, f"{name}: {key} changes nothing")
    page.keyboard.press("+")
    page.keyboard.press("Home")
    checks.that(picture(page) == before, f"{name}: Home is not where it began")
    box = canvas.bounding_box()
    page.mouse.move(box["x"] + 100, box["y"] + 100)
    page.mouse.down()
    page.mouse.move(box["x"] + 180, box["y"] + 130, steps=3)
    page.mouse.up()
    checks.that(picture(page) != before, f"{name}: dragging changes nothing")
    page.locator("[data-part='reset']").click()
    checks.that(picture(page) == before, f"{name}: the button does not reset")
    check_speed(page, checks, name)


def check_speed(page, checks, name):
    """Played at any speed for half a second it is where it should be; at the end it stops, or begins again."""
    scrub, play = page.locator("[data-part='scrub']"), page.locator("[data-part='play']")
    duration = float(page.locator("[data-part='time']").inner_text().split()[2])
    for speed in (0.5, 1, 2, 4):
        page.locator("[data-part='speed']").select_option(f"{speed:g}")
        scrub.fill("0")
        play.click()
        page.clock.run_for(500)
        play.click()
        played = float(scrub.input_value()) / 1000 * duration
        expected = min(0.5 * speed, duration)
        # The clock ticks in frames of 16 ms, and the slider in thousandths.
        near = 0.033 * speed + duration / 1000
        checks.that(abs(played - expected) < near, f"{name}: {played} s instead of {expected} s at {speed} ×")
    for loop in (False, True):
        page.locator("[data-part='loop']").set_checked(loop)
        scrub.fill("990")
        play.click()
        page.clock.run_for(500)
        at_end = scrub.input_value() == scrub.get_attribute("max")
        checks.that(at_end != loop, f"{name}: at the end, loop {loop}")
    play.click()


def check_film(browser, path, checks):
    """The button plays the motion once and hands over a film, which begins as WebM does (RFC 8794: the EBML header's identifier)."""
    with opened(browser, path, checks) as page:
        name, button = path.parent.name, page.locator("[data-part='record']")
        checks.that(button.is_visible(), f"{name}: no button saves a film")
        page.locator("[data-part='speed']").select_option("4")
        page.locator("[data-part='loop']").set_checked(True)
        film = downloaded(page, button)
        checks.equal(film[:4], bytes.fromhex("1a45dfa3"), f"{name}: film")
        checks.equal(button.inner_text(), "Save film", f"{name}: button after a film")
        checks.equal(page.locator("[data-part='play']").inner_text(), "Play", f"{name}: plays on after a film")


def check_large(browser, path, checks, pictures):
    """A table of ten thousand rows does not keep the reader waiting."""
    page = path.read_text()
    pattern = r'(<script type="text/csv" data-table="summary" data-encoding=")text">(.*?)</script>'
    header, *rows = re.search(pattern, page, re.S).group(2).strip().split("\n")
    lines = [header] + [rows[i % len(rows)] for i in range(10_000)]
    data = base64.b64encode(gzip.compress("\n".join(lines + [""]).encode())).decode()
    large = pictures / "large.html"
    large.write_text(re.sub(pattern, lambda m: f'{m.group(1)}gzip">{data}</script>', page, flags=re.S))
    start = time.monotonic()
    with opened(browser, large, checks) as page:
        seconds = time.monotonic() - start
        checks.that(seconds < 5, f"ten thousand rows take {seconds:.1f} s")
        section = page.locator("#table-summary")
        checks.equal(section.locator("output").inner_text(), "10000 rows", "large: rows")
        checks.equal(section.locator("tbody tr").count(), FIRST_ROWS, "large: rows at first")
        section.locator(".more").click()
        checks.equal(section.locator("tbody tr").count(), FIRST_ROWS + 1000, "large: rows after a click")
    return seconds


def check_page(folder, pictures, axe):
    """What is wrong with a page, how much was checked and how many motions it has."""
    checks, motions, path = Checks(), 0, folder / "report.html"
    size = path.stat().st_size
    checks.that(size < MOST_BYTES, f"{folder.name}: {size} bytes")
    is_task = "task" in stored.experiment(folder)
    with chromium() as browser:
        with opened(browser, path, checks) as page:
            check_structure(page, checks, folder.name, axe)
            check_tables(page, folder, checks)
            check_files(page, folder, checks)
            checks.equal(page.locator("canvas").count(), int(is_task), f"{folder.name}: views")
            if is_task:
                check_motion(page, folder, checks)
                motions += check_ends(page, folder, checks)
                check_largest_turn(page, folder, checks)
                check_worst_moments(page, folder, checks)
            check_keyboard(page, checks, folder.name)
        check_looks(browser, path, checks, pictures)
        if folder.name == "default":
            check_film(browser, path, checks)
    print(f"{folder.name:14} {size / 1e3:6.0f} kB {checks.made:5} checks", flush=True)
    return checks.failed, checks.made, motions


def main(results, pictures, axe):
    folders = sorted(path.parent for path in results.glob("*/report.html"))
    # A page mostly waits for its browser.
    with ThreadPoolExecutor(2 * os.cpu_count()) as pool:
        found = list(pool.map(lambda folder: check_page(folder, pictures, axe), folders))
    large = Checks()
    with chromium() as browser:
        seconds = check_large(browser, results / "default" / "report.html", large, pictures)
    failed = [message for own, _, _ in found for message in own] + large.failed
    made, motions = sum(made for _, made, _ in found) + large.made, sum(motions for _, _, motions in found)
    print(f"ten thousand rows open in {seconds:.1f} s; axe {'ran' if axe.exists() else 'is not there'}")
    print(f"{len(folders)} pages, {motions} motions, {made} checks, {len(failed)} failed")
    return bool(failed) or not folders


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:])))
