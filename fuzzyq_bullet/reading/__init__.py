"""Reading what people write: trees that know their lines, bounded data, mistakes in words."""
