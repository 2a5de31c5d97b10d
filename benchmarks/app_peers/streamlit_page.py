"""A slider and three diagrams of a machine with Streamlit: ``streamlit run streamlit_page.py -- CASE FIELD``."""

import sys

import plots
import streamlit

case, path = sys.argv[1:3]
one = plots.field(case, path)
value = streamlit.slider(path, one.low, one.high, one.value, one.step)
for place, figure in enumerate(plots.figures(case, path, one.text(value))):
    streamlit.plotly_chart(figure, key=f"diagram-{place}")
