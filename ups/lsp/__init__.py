"""The language server of decks: what ``ups lint`` and ``ups explain`` know, shown in an editor while typing.

``ups.lsp.server`` speaks the protocol with pygls; all else in this package knows neither the protocol nor pygls
and can be called with texts and offsets: ``spot`` (what is under the cursor), ``context`` (which record declares
it), ``hover``, ``completion``, ``definition`` and ``project`` (the open files and what is wrong with them).
"""
