"""The workbench: one page that shows a gear in a browser, without a server."""
