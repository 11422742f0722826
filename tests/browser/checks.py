"""What the browser's tests share: a page that is opened, findings that are counted, what a page requests and logs."""

import os

import assemble
import sample

SEEN = "e => e.getClientRects().length && e.checkVisibility({visibilityProperty: true, opacityProperty: true})"
VISIBLE = "(selector => [...document.querySelectorAll(selector)].filter(" + SEEN + "))"
SCENES = VISIBLE + "('.scene').map(s => s.ariaLabel)"


class Checks:
    """A browser, a folder for its pages, and what failed. `report`: the page that is used, else the sample's; `change` may
    damage a part of the sample's page on the way, to see whether a check notices."""

    def __init__(self, browser, out, change=lambda name, text: text, report=None):
        self.browser, self.out, self.change, self.report, self.failures = browser, out, change, report, []

    def open(self, model=None, address="", width=1280):
        """Anew at `#address`: a page of `model`; without one the report."""
        self.browser.size(width, 900)
        self.file = self.report
        if model or not self.report:
            self.file = os.path.join(self.out, "page.html")
            with open(self.file, "w", encoding="utf-8") as write:
                write.write(assemble.assemble(model or sample.make(), self.change))
        self.browser.open("about:blank")
        self.browser.open("file://" + os.path.abspath(self.file) + ("#" + address if address else ""))
        self.browser.settle()
        return self.browser

    def empty(self, found, what):
        print(("ok      " if not found else "FAILED  ") + what, flush=True)
        if found:
            self.failures.append(what)
            for line in list(found)[:12]:
                print("        " + str(line)[:300])

    def true(self, holds, what, detail=""):
        self.empty([] if holds else [detail or "does not hold"], what)

    def quiet(self, what):
        requests, errors = logged(self.browser.events)
        self.empty(requests, f"{what}: no request leaves the page")
        self.empty(errors, f"{what}: nothing is logged as error or warning")


def logged(events):
    """Requests that left the page, and what was logged as error or warning."""
    requests, errors = [], []
    for event in events:
        kind, params = event.get("method"), event.get("params", {})
        if kind == "Network.requestWillBeSent":
            if not params["request"]["url"].startswith(("data:", "blob:")) and params.get("type") != "Document":
                requests.append(params["request"]["url"])
        elif kind == "Runtime.exceptionThrown":
            errors.append(str(params["exceptionDetails"])[:300])
        elif kind == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning", "assert"):
            errors.append(str(params["args"])[:300])
        elif kind == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            errors.append(params["entry"]["text"][:300])
    return requests, errors
