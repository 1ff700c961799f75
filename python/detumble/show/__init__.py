"""Pictures: the figures of the paper's case, and one page for a single flight. Matplotlib is imported when one is plotted."""
