#!/usr/bin/env python3
"""Opens a report that taut wrote and uses every scene of it: nothing is requested, logged, cut off, crowded or empty.

    report.py REPORT.html OUT        exit 0: all is well; 1: it is not; 77: there is no Chromium
"""

import os
import sys

import accessibility
import chromium
import page

EMPTY = """[...document.querySelectorAll('section, .card, figure, ul, dl, tbody, .claims')]
    .filter(e => e.checkVisibility() && !e.textContent.trim()).map(e => e.outerHTML.slice(0, 80))"""


def main(report, out):
    program = chromium.find()
    if program is None:
        print("SKIPPED: no chromium on this machine")
        return 77
    os.makedirs(out, exist_ok=True)
    browser = chromium.Browser(program)
    checks = page.Checks(browser, out)
    try:
        browser.size(1280, 900)
        browser.open(report)
        browser.settle()
        checks.true(browser.run("document.querySelectorAll('main > section').length >= 4"), "the sections are drawn")
        for scene in browser.run("model.scenes.map(scene => scene.id)"):
            browser.run(f"state.set({{scene: {scene!r}}})")
            browser.settle()
            height = browser.run("document.documentElement.scrollHeight")
            checks.true(height < 9000, f"{scene}: the page is below 9,000 px", height)
            checks.empty(browser.run(accessibility.CROWDED), f"{scene}: no text of a chart is cut off or lies on another")
            checks.empty(browser.run(EMPTY), f"{scene}: nothing that is shown is empty")
        placed = "model.claims.filter(c => !document.getElementById('claim-' + c.id)).map(c => c.id)"
        checks.empty(browser.run(placed), "every claim is on the page")
        checks.empty(browser.run(accessibility.CONTRAST), "texts have contrast")
        checks.empty(browser.run(accessibility.RULES), "accessibility: the serious rules, written out")
        browser.screenshot(os.path.join(out, "report.png"))
        for width in (768, 390):
            browser.size(width, 900)
            browser.settle()
            wide = browser.run("document.documentElement.scrollWidth")
            checks.true(wide <= width, f"{width} px: no sideways scrolling", wide)
        page.quiet(checks, "the report")
    finally:
        browser.close()
    return 1 if checks.failures else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
