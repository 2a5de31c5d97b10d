"""Parts of a page that change while a hand moves: each is drawn anew alone, not the whole page.

A usual element of NiceGUI that changes has the browser build the page anew, which takes longer than a first look at a
machine is computed in. These take what changed by a method of their own component.
"""
