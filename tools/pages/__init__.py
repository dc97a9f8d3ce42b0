"""Documentation site: run the code of its pages, make its references, build and check it."""
