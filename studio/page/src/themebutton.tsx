// Light or dark, kept for the next time.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { Moon, Sun } from "lucide-preact";
import { IconButton } from "./parts";

export function ThemeButton(): JSX.Element {
  const system = window.matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
  const [theme, setTheme] = useState(localStorage.getItem("theme") ?? system);
  useEffect(() => {
    document.documentElement.dataset["theme"] = theme;
  }, [theme]);
  const other = theme === "light" ? "dark" : "light";
  return (
    <IconButton
      icon={theme === "light" ? Moon : Sun}
      label={`Use the ${other} theme`}
      onClick={() => {
        localStorage.setItem("theme", other);
        setTheme(other);
      }}
    />
  );
}
