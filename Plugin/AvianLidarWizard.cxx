// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarWizard.h"

#include "pqActiveObjects.h"
#include "pqFileChooserWidget.h"

#include "vtkPVProxyDefinitionIterator.h"
#include "vtkPVXMLElement.h"
#include "vtkSMProxy.h"
#include "vtkSMProxyDefinitionManager.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSmartPointer.h"

#include <QComboBox>
#include <QFormLayout>
#include <QJsonArray>
#include <QJsonDocument>
#include <QLabel>
#include <QMap>
#include <QResource>
#include <QSpinBox>
#include <QWizard>
#include <QWizardPage>

namespace
{
constexpr char FirstSensor[] = "AvianLidarSearch905";
constexpr char FirstSpecies[] = "herring gull";
constexpr int FirstNumber = 12;
constexpr int MostBirds = 1000; ///< largest number of birds, equal to IDS of the macro

/// Names in menus, and proxies, of all sensors that are sources.
QMap<QString, QString> Sensors()
{
  QMap<QString, QString> found;
  vtkSMSessionProxyManager* manager = pqActiveObjects::instance().proxyManager();
  if (!manager)
  {
    return found; // no connection to a server
  }
  auto each = vtkSmartPointer<vtkPVProxyDefinitionIterator>::Take(
    manager->GetProxyDefinitionManager()->NewSingleGroupIterator("sources"));
  for (each->InitTraversal(); !each->IsDoneWithTraversal(); each->GoToNextItem())
  {
    const QString name = each->GetProxyName();
    vtkSMProxy* prototype = name.startsWith("AvianLidar") && name != "AvianLidarBeamSource"
      ? manager->GetPrototypeProxy("sources", each->GetProxyName())
      : nullptr;
    if (prototype && QString(prototype->GetVTKClassName()) == "vtkAvianLidarBeamSource")
    {
      vtkPVXMLElement* hints = prototype->GetHints();
      auto* hint = hints ? hints->FindNestedElementByName("AvianLidarMenu") : nullptr;
      const QString label = prototype->GetXMLLabel();
      found[hint ? QString(hint->GetAttributeOrEmpty("text")) : label.mid(12)] = name;
    }
  }
  return found;
}

/// Text as a Python literal.
QString Quoted(QString text)
{
  return "'" + text.replace('\\', "\\\\").replace('\'', "\\'").replace('\n', "\\n") + "'";
}

class Wizard : public QWizard
{
public:
  explicit Wizard(QWidget* parent);
  QString Answers() const;

private:
  QFormLayout* AddPage(const QString& title, const QString& text);
  QComboBox* AddChoice(QFormLayout* layout, const QString& label, const char* name);

  pqFileChooserWidget* Scene = nullptr;
  QComboBox* Sensor = nullptr;
  QComboBox* Species = nullptr;
  QSpinBox* Number = nullptr;
  QComboBox* Weather = nullptr;
};

//------------------------------------------------------------------------------
Wizard::Wizard(QWidget* parent)
  : QWizard(parent)
{
  this->setObjectName("AvianLidarWizard");
  this->setWindowTitle("Avian Lidar: Scan");
  this->setOption(QWizard::HaveFinishButtonOnEarlyPages);
  this->setOption(QWizard::NoBackButtonOnStartPage);

  QFormLayout* page = this->AddPage("Scene",
    "A scene (.lidarscene.json), or surfaces in metres, z up (.obj, .stl, .vtp, ...). Without a "
    "file, the scene is the plugin's airport.");
  this->Scene = new pqFileChooserWidget(this);
  this->Scene->setObjectName("Scene");
  this->Scene->setServer(pqActiveObjects::instance().activeServer());
  this->Scene->setForceSingleFile(true);
  page->addRow("File (empty: the airport)", this->Scene);

  page = this->AddPage("Sensor",
    "The lidar stands at the position that the scene gives, or beside the surfaces. The values of "
    "the lidar can be changed afterwards.");
  this->Sensor = this->AddChoice(page, "Lidar", "Sensor");
  const QMap<QString, QString> sensors = Sensors();
  for (auto sensor = sensors.begin(); sensor != sensors.end(); ++sensor)
  {
    this->Sensor->addItem(sensor.key(), sensor.value());
  }
  this->Sensor->setCurrentIndex(this->Sensor->findData(FirstSensor));

  page =
    this->AddPage("Birds", "Birds that cross within 250 m of the lidar, 4 to 20 m above its foot.");
  this->Species = this->AddChoice(page, "Species", "Species");
  const QString table = QString::fromUtf8(QResource(":/AvianLidar/species.csv").uncompressedData());
  for (const QString& line : table.split('\n', Qt::SkipEmptyParts).mid(2)) // after the head
  {
    this->Species->addItem(line.section(',', 0, 0));
  }
  this->Species->setCurrentText(FirstSpecies);
  this->Number = new QSpinBox(this);
  this->Number->setObjectName("Number");
  this->Number->setRange(0, MostBirds);
  this->Number->setValue(FirstNumber);
  this->Number->setSpecialValueText("none");
  page->addRow("Number", this->Number);

  page = this->AddPage("Weather",
    "Fog, rain and ground fog send light back, and need a lidar with a receiver aperture "
    "(not Airport 16, Airport 32 or Corridor C16).");
  this->Weather = this->AddChoice(page, "Weather", "Weather");
  const QResource weathers(":/AvianLidar/weathers.json");
  for (const QJsonValue& weather : QJsonDocument::fromJson(weathers.uncompressedData()).array())
  {
    this->Weather->addItem(weather["text"].toString(), weather["name"].toString());
  }
}

//------------------------------------------------------------------------------
QFormLayout* Wizard::AddPage(const QString& title, const QString& text)
{
  auto* page = new QWizardPage(this);
  page->setTitle(title);
  page->setFinalPage(true); // with the button Finish
  auto* layout = new QFormLayout(page);
  auto* label = new QLabel(text, page);
  label->setWordWrap(true);
  layout->addRow(label);
  this->addPage(page);
  return layout;
}

//------------------------------------------------------------------------------
QComboBox* Wizard::AddChoice(QFormLayout* layout, const QString& label, const char* name)
{
  auto* choice = new QComboBox(this);
  choice->setObjectName(name);
  layout->addRow(label, choice);
  return choice;
}

//------------------------------------------------------------------------------
QString Wizard::Answers() const
{
  const QString scene = this->Scene->singleFilename();
  return QString("{'scene': %1, 'sensor': %2, 'species': %3, 'number': %4, 'weather': %5}")
    .arg(scene.isEmpty() ? QString("None") : Quoted(scene),
      Quoted(this->Sensor->currentData().toString()), Quoted(this->Species->currentText()),
      QString::number(this->Number->value()), Quoted(this->Weather->currentData().toString()));
}
}

//------------------------------------------------------------------------------
QString AvianLidarAskForScan(QWidget* parent)
{
  Wizard wizard(parent);
  return wizard.exec() == QDialog::Accepted ? wizard.Answers() : QString();
}
