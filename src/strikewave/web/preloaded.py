"""What the processes of the app need: imported once, in the process that they are copied from."""

from strikewave.analyses.machine import report as report
from strikewave.web.pages.case import machine_view as machine_view
from strikewave.web.pages.case import target_view as target_view
