"""Shared by the browser's tests: opens pages, counts findings, and lists what a page requests and logs."""

import json
import os

SEEN = "e => e.getClientRects().length && e.checkVisibility({visibilityProperty: true, opacityProperty: true})"
VISIBLE = "(selector => [...document.querySelectorAll(selector)].filter(" + SEEN + "))"
SCENES = VISIBLE + "('.scene').map(s => s.ariaLabel)"


class Checks:
    """A browser, a folder for its pages, the report under test, and the failures."""

    def __init__(self, browser, out, report):
        self.browser, self.out, self.report, self.failures = browser, out, report, []

    def model(self):
        """The model in the report, and the parts of the page before and after it."""
        with open(self.report, encoding="utf-8") as read:
            before, rest = read.read().split('id="model">', 1)
        model, behind = rest.split("</script>", 1)
        return json.loads(model), before + 'id="model">', "</script>" + behind

    def open(self, model=None, address="", width=1280):
        """Opens the report, or its page with another model, anew at `#address`."""
        self.browser.size(width, 900)
        self.file = self.report
        if model:
            self.file = os.path.join(self.out, "page.html")
            _, before, behind = self.model()
            with open(self.file, "w", encoding="utf-8") as write:
                write.write(before + json.dumps(model).replace("<", "\\u003c") + behind)
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
    """Requests that left the page, and errors and warnings in its log."""
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
