// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarErrors.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqOutputPort.h"
#include "pqPipelineFilter.h"
#include "pqPipelineSource.h"
#include "pqServerManagerModel.h"

#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkSMProxy.h"
#include "vtkType.h"

#include <QAction>
#include <QApplication>
#include <QPointer>
#include <QWidget>

#include <algorithm>
#include <set>
#include <string>

namespace
{
//------------------------------------------------------------------------------
// Lives as long as the application of the window.
class Errors : public QObject
{
public:
  explicit Errors(pqApplicationCore* application)
    : QObject(application)
  {
    pqServerManagerModel* model = application->getServerManagerModel();
    connect(model, &pqServerManagerModel::dataUpdated, this, [this] { this->LookAgain(); });
    connect(&pqActiveObjects::instance(), &pqActiveObjects::portChanged, this,
      [this] { this->GuardSaving(); });
  }

private:
  static bool IsOurs(pqPipelineSource* source)
  {
    const char* name = source->getProxy()->GetXMLName();
    return name && std::string(name).rfind("AvianLidar", 0) == 0;
  }

  // True if all ranks' data of an output, or one that it is made from, is an error: filters
  // between may have lost it.
  static bool HasError(pqOutputPort* port, std::set<pqPipelineSource*>& seen)
  {
    pqPipelineSource* source = port ? port->getSource() : nullptr;
    if (!source)
    {
      return false;
    }
    vtkPVDataInformation* data = IsOurs(source) ? port->getDataInformation() : nullptr;
    vtkPVArrayInformation* error =
      data ? data->GetArrayInformation("error", vtkDataObject::FIELD) : nullptr;
    if (error && error->GetDataType() == VTK_STRING)
    {
      return true;
    }
    auto* filter = qobject_cast<pqPipelineFilter*>(source);
    const QList<pqOutputPort*> inputs =
      filter && seen.insert(source).second ? filter->getAllInputs() : QList<pqOutputPort*>();
    return std::any_of(
      inputs.begin(), inputs.end(), [&seen](pqOutputPort* input) { return HasError(input, seen); });
  }

  // ParaView enables the action for each output that becomes the active one.
  void GuardSaving()
  {
    if (!this->Saving)
    {
      this->Saving = FindAction();
      if (this->Saving)
      {
        connect(this->Saving, &QAction::changed, this, [this] { this->GuardSaving(); });
      }
    }
    std::set<pqPipelineSource*> seen;
    if (this->Saving && this->Saving->isEnabled() &&
      HasError(pqActiveObjects::instance().activePort(), seen))
    {
      this->Saving->setEnabled(false);
    }
  }

  // What was bad may be good now: ParaView decides anew.
  void LookAgain()
  {
    for (QObject* reaction : this->Saving ? this->Saving->children() : QObjectList())
    {
      if (reaction->inherits("pqSaveDataReaction"))
      {
        QMetaObject::invokeMethod(reaction, "updateEnableState");
      }
    }
    this->GuardSaving();
  }

  static QAction* FindAction()
  {
    for (QWidget* top : QApplication::topLevelWidgets())
    {
      if (auto* action = top->findChild<QAction*>("actionFileSaveData"))
      {
        return action;
      }
    }
    return nullptr;
  }

  QPointer<QAction> Saving;
};
}

//------------------------------------------------------------------------------
void AvianLidarGuardSaving()
{
  pqApplicationCore* application = pqApplicationCore::instance();
  static QPointer<Errors> errors;
  if (application && application->getServerManagerModel() && !errors)
  {
    errors = new Errors(application);
  }
}
