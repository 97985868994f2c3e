"""Run all studies and write their report: python pipelines/all_studies.py -o results/studies."""

from studies.all_studies import main

if __name__ == "__main__":
    main()
