// Which project the page's address names.

/** Empty: the first page. */
export function addressed(): string {
  return decodeURIComponent(location.hash.replace(/^#\/?/, ""));
}

export function go(project: string): void {
  location.hash = project ? `#/${encodeURIComponent(project)}` : "#/";
}
