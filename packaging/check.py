#!/usr/bin/env python3
"""Reads the recipes as rattler-build, Docker and Singularity do: what they name must be there.

Needs py-rattler-build, dockerfile and spython, and the tarball's folder in target/packages. Nothing
is built.
"""

import pathlib
import sys

import dockerfile
import rattler_build
from spython.main.parse.parsers import get_parser

HERE = pathlib.Path(__file__).parent
PACKAGES = HERE / "../target/packages"
MANIFEST = (HERE / "../Cargo.toml").read_text()


def check_conda():
    recipe = rattler_build.Stage0Recipe.from_file(HERE / "conda/recipe.yaml")
    variants = rattler_build.VariantConfig.from_file(HERE / "conda/variants.yaml")
    for rendered in recipe.render(variants):
        package = rendered.recipe.package
        assert f'\nversion = "{package.version}"\n' in MANIFEST, f"{package.version} is not Cargo.toml's"
        print("conda:", package.name, package.version, rendered.recipe.requirements.build)


def check_docker():
    steps = {step.cmd: step.value for step in dockerfile.parse_file(str(HERE / "Dockerfile"))}
    assert steps["ENTRYPOINT"] == ("photosphere",), steps["ENTRYPOINT"]
    check_in_tarball(steps["COPY"][0])
    print("Docker:", steps)


def check_apptainer():
    (recipe,) = get_parser("singularity")(str(HERE / "photosphere.def")).recipe.values()
    assert 'exec photosphere "$@"' in recipe.cmd, recipe.cmd
    for line in recipe.files:
        check_in_tarball(line.split()[0])
    print("Apptainer:", recipe.fromHeader, recipe.files, recipe.install, recipe.cmd)


def check_in_tarball(pattern):
    """Exits unless the pattern is one folder of target/packages, or all in it, with the program."""
    folders = list(PACKAGES.glob(pattern.removesuffix("/*")))
    if len(folders) != 1 or not (folders[0] / "bin/photosphere").is_file():
        sys.exit(f"{pattern} is not one folder with the program: run scripts/package.sh tarball")


check_conda()
check_docker()
check_apptainer()
