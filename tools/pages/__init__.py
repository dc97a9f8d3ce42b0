"""The documentation site: runs what its pages show, makes its references, builds and checks it."""
