"""Reads recipe.yaml as rattler-build does. Needs py-rattler-build."""

import pathlib

import rattler_build

here = pathlib.Path(__file__).parent
recipe = rattler_build.Stage0Recipe.from_file(here / "recipe.yaml")
variants = rattler_build.VariantConfig.from_file(here / "variants.yaml")
manifest = (here / "../../Cargo.toml").read_text()
for rendered in recipe.render(variants):
    package = rendered.recipe.package
    assert f'\nversion = "{package.version}"\n' in manifest, f"{package.version} is not Cargo.toml's"
    print(package.name, package.version, rendered.recipe.requirements.build)
