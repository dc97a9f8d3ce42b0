!> Largest demands of a run, found by `rwmf_simulation_recorder_peak_search`.
module rwmf_simulation_recorder_demand_extremes
   use rwmf_core_kinds, only: wp
   use rwmf_model_floor_motion, only: follows_roof
   use rwmf_problem_quantity_values, only: values_t, put
   use rwmf_model_scene, only: demand_list_t
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_model_system_demands, only: building_of, building_t, demands_at, demands_t
   use rwmf_model_system_reactions, only: has_section_forces
   use rwmf_problem_case, only: case_t
   use rwmf_problem_frame_strength, only: has_strength, storeys_have_strengths
   use rwmf_problem_quantity_table, only: id
   use rwmf_simulation_recorder_peak_search, only: begin_search, keep_sought, &
      peak_family_t, peak_search_t, put_peaks
   implicit none
   private

   public :: demand_recorder_t, create_demands
   public :: put_storeys, put_demands, put_demand_extremes
   public :: put_constants, lanes_find

   !> Running maxima of the magnitudes of the demands.
   !>
   !> The order is: storey drifts [-] and shears [m/s2], floor accelerations [m/s2], overturning
   !> moment [m]. Shear [m/s2] and moment [m2/s2] in the wall follow.
   type, extends(peak_search_t) :: demand_recorder_t
      type(building_t) :: building
      type(demand_list_t) :: list
      !! demands that loops over lanes compute
      type(demands_t) :: present
      !! demands at the last evaluated instant
   contains
      procedure :: find => find_demands
      procedure :: note_place => note_height
   end type demand_recorder_t

contains

   !> Initialise the demands if the case requests them.
   subroutine create_demands(recorder, case, equation, y)
      type(demand_recorder_t), allocatable, intent(out) :: recorder
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states) at the beginning
      integer :: n

      if (.not. allocated(case%output)) return
      if (.not. case%output%demands) return
      allocate (recorder)
      call building_of(case, equation, recorder%building)
      associate (building => recorder%building, drifts => recorder%building%drifts)
         n = 2*drifts + building%floors + 3
         call begin_search(recorder, equation, y, spread(-1.0_wp, 1, n))
         if (follows_roof(equation)) then
            recorder%leader(2:drifts) = 1
            if (has_strength(case) .and. .not. storeys_have_strengths(case)) then
               recorder%leader(drifts + 2:2*drifts) = drifts + 1
            end if
         end if
         if (building%is_linear) recorder%leader(drifts + 1:2*drifts) = recorder%leader(:drifts)
      end associate
      recorder%families = families_of(recorder%building, equation)
      call keep_sought(recorder, case%output)
      associate (building => recorder%building)
         building%has_sections = any(recorder%leader(n - 1:) > 0)
         recorder%list = demand_list_t(building%floors, building%drifts, building%has_sections)
      end associate
      if (.not. has_section_forces(equation)) recorder%building%has_sections = .false.
   end subroutine create_demands

   !> Outputs of the searches. Drifts that follow the roof are shares of its displacement.
   pure function families_of(building, equation) result(families)
      type(building_t), intent(in) :: building
      type(equation_t), intent(in) :: equation
      type(peak_family_t), allocatable :: families(:)

      associate (s => building%drifts, n => building%floors, g => equation%p%g, &
                 last => 2*building%drifts + building%floors, &
                 has_sections => equation%has_wall .and. has_section_forces(equation))
         families = [ &
            peak_family_t(id%storey_i_drift_max, 1, s, largest=id%storey_drift_max, &
            time=id%t_storey_drift_max_s, is_put=.not. follows_roof(equation)), &
            peak_family_t(id%storey_i_shear_max_over_m_w_g, s + 1, s, unit=g), &
            peak_family_t(id%floor_i_acceleration_max_g, 2*s + 1, n, unit=g, &
            largest=id%floor_acceleration_max_g, time=id%t_floor_acceleration_max_s), &
            peak_family_t(id%overturning_moment_max_over_weight_m, last + 1, &
            time=id%t_overturning_moment_max_s, is_put=building%roof_height > 0), &
            peak_family_t(id%wall_shear_max_over_m_w_g, last + 2, unit=g, &
            height=id%wall_shear_max_height_m, is_put=has_sections), &
            peak_family_t(id%wall_moment_max_over_m_w_g_m, last + 3, unit=g, &
            height=id%wall_moment_max_height_m, is_put=has_sections)]
      end associate
   end function families_of

   !> Return whether loops over lanes can compute the demands: storeys that follow one mode have no
   !> states.
   pure logical function lanes_find(recorder, equation)
      type(demand_recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation

      lanes_find = equation%parts%is_complete .and. (recorder%building%drifts == 0 &
         .or. equation%floors%n > 0)
   end function lanes_find

   !> Fill in the constants of the building for loops over lanes.
   pure subroutine put_constants(recorder, constants)
      type(demand_recorder_t), intent(in) :: recorder
      real(wp), intent(out) :: constants(:)
      !! input of `lane_demands`, each in its unit

      associate (building => recorder%building)
         constants = 0
         constants(:2) = [building%unit, 1/building%weight]
         if (allocated(building%z)) constants(3:2 + building%floors) = building%m*building%z &
            /building%weight
         constants(3 + building%floors:) = 1/building%height
      end associate
   end subroutine put_constants

   !> Compute the magnitudes of the demands at a state.
   subroutine find_demands(self, equation, t, y, y_dot, found)
      class(demand_recorder_t), intent(inout) :: self
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_dot(:)
      real(wp), intent(out) :: found(:)
      !! (demands)

      call demands_at(self%building, equation, t, y, y_dot, self%present)
      associate (present => self%present, n => size(found), s => self%building%drifts)
         found(:s) = abs(present%drift)
         found(s + 1:2*s) = abs(present%shear)
         found(2*s + 1:n - 3) = abs(present%acceleration)
         found(n - 2:) = [abs(present%overturning), present%wall%shear, present%wall%moment]
      end associate
   end subroutine find_demands

   !> Note the height of a new largest shear or moment in the wall.
   subroutine note_height(self, q)
      class(demand_recorder_t), intent(inout) :: self
      integer, intent(in) :: q
      !! number of the demand

      associate (wall => self%present%wall, n => size(self%largest))
         if (q == n - 1) self%z_largest(q) = wall%z_shear
         if (q == n) self%z_largest(q) = wall%z_moment
      end associate
   end subroutine note_height

   !> Compute the demands, and fill in storey columns that only a history with demands has.
   subroutine put_storeys(row, recorder, equation, t, y, y_dot)
      type(values_t), intent(inout) :: row
      type(demand_recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates

      call demands_at(recorder%building, equation, t, y, y_dot, recorder%present)
      associate (present => recorder%present, g => equation%p%g)
         if (equation%floors%n == 0) call put(row, id%storey_i_drift, present%drift)
         if (.not. equation%floors%yields .or. follows_roof(equation)) call put(row, &
            id%storey_i_shear_over_m_w_g, present%shear/g)
      end associate
   end subroutine put_storeys

   !> Fill in the columns of floors and wall, with the demands computed by `put_storeys`.
   subroutine put_demands(row, recorder, equation)
      type(values_t), intent(inout) :: row
      type(demand_recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation

      associate (present => recorder%present, g => equation%p%g)
         call put(row, id%floor_i_acceleration_g, present%acceleration/g)
         if (recorder%building%roof_height > 0) call put(row, id%overturning_moment_over_weight_m, &
            present%overturning)
         if (.not. (equation%has_wall .and. has_section_forces(equation))) return
         call put(row, id%wall_shear_over_m_w_g, present%wall%shear/g)
         call put(row, id%wall_moment_over_m_w_g_m, present%wall%moment/g)
      end associate
   end subroutine put_demands

   !> Put the largest demands of the run.
   subroutine put_demand_extremes(values, recorder, equation, u_s_max, t_u_s_max)
      type(values_t), intent(inout) :: values
      type(demand_recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: u_s_max
      !! largest |u_s| [m]
      real(wp), intent(in) :: t_u_s_max
      !! time of u_s_max [s]

      call put_peaks(values, recorder)
      associate (building => recorder%building)
         if (building%floors > 0 .and. building%roof_height > 0) then
            call put(values, id%roof_drift_max, u_s_max/building%roof_height)
            call put(values, id%t_roof_drift_max_s, t_u_s_max)
         end if
         if (building%drifts == 0 .or. .not. follows_roof(equation)) return
         associate (drifts => u_s_max*abs(building%bend)/building%height)
            call put(values, id%storey_i_drift_max, drifts)
            call put(values, id%storey_drift_max, maxval(drifts))
            call put(values, id%t_storey_drift_max_s, t_u_s_max)
         end associate
      end associate
   end subroutine put_demand_extremes

end module rwmf_simulation_recorder_demand_extremes
