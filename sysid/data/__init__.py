"""From files to loops: manifest, readers, records, cycles, quality."""
