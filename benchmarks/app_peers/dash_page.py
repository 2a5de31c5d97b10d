"""A slider and three diagrams of a machine with Dash: ``python dash_page.py CASE FIELD PORT``."""

import sys

import plots
from dash import Dash, Input, Output, dcc, html

case, path, port = sys.argv[1:4]
one = plots.field(case, path)
app = Dash(__name__, serve_locally=True)
names = ["force", "acceleration", "train"]
slider = dcc.Slider(one.low, one.high, one.step, value=one.value, id="slider", updatemode="drag", marks=None)
app.layout = html.Div([slider, *(dcc.Graph(id=name) for name in names)])


@app.callback([Output(name, "figure") for name in names], Input("slider", "value"))
def draw(value):
    """Return the diagrams at a place of the slider."""
    return plots.figures(case, path, one.text(value))


app.run(port=int(port), debug=False)
